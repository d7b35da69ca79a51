// Specialisation constants of the plan; ANY if materials differ or the über-shader is requested. Fixed values let the driver
// remove unused code.

#import "scene/plan_constants"

fn planned(value: u32, plan: u32) -> u32 {
    return select(plan, value, plan == ANY);
}
