// What the plan fixes for all materials of a scene when the pipeline is made; ANY where materials differ or the general
// pipeline is wanted. Twin of src/render/plan.rs. Fixed values let the driver drop what the scene does not call for.

const ANY: u32 = 0xffffffffu;

override PLAN_LOBE: u32 = 0xffffffffu;
override PLAN_CURVE: u32 = 0xffffffffu;
override PLAN_HORIZON: u32 = 0xffffffffu;
override PLAN_FRESNEL: u32 = 0xffffffffu;
// 1: some material may stretch its lobe.
override PLAN_ANISOTROPY: u32 = 1u;
// 1: some material may have a Lambertian base.
override PLAN_BASE: u32 = 1u;
// 1: some material may have a specular lobe.
override PLAN_SPECULAR: u32 = 1u;
// 1: some material may emit.
override PLAN_EMISSION: u32 = 1u;
// 1: some material may transmit light.
override PLAN_TRANSMISSION: u32 = 1u;
// 1: some material that transmits light may absorb it inside.
override PLAN_ABSORPTION: u32 = 1u;
// 1: the environment is sampled.
override PLAN_LIGHT_SAMPLING: u32 = 1u;
// 1: some triangle may emit, and is sampled.
override PLAN_EMITTER_SAMPLING: u32 = 1u;
// 1: the lens may be open.
override PLAN_LENS: u32 = 1u;
// 1: indirect contributions are limited.
override PLAN_FIREFLY_CLAMP: u32 = 1u;

fn planned(value: u32, plan: u32) -> u32 {
    return select(plan, value, plan == ANY);
}
