// What the plan fixes for all materials of a scene when the pipeline is made; ANY where materials differ or the general
// pipeline is wanted. Fixed values let the driver drop what the scene does not call for.

#import "scene/plan_constants"

fn planned(value: u32, plan: u32) -> u32 {
    return select(plan, value, plan == ANY);
}
