// What the plan fixes for all materials of a scene when the pipeline is made; ANY where materials differ or the general
// pipeline is wanted. Twin of src/document/effect. Fixed values let the driver drop what the scene does not call for.

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
// 1: rays that leave a surface may meet another one.
override PLAN_INTERREFLECTION: u32 = 1u;
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
// 1: some metal's reflection may be tinted towards the edge.
override PLAN_EDGE_TINT: u32 = 1u;
// 1: some material may have a coat.
override PLAN_COAT: u32 = 1u;
// 1: some material may have a texture of this kind.
override PLAN_COLOR_TEXTURES: u32 = 1u;
override PLAN_ROUGHNESS_TEXTURES: u32 = 1u;
override PLAN_EMISSION_TEXTURES: u32 = 1u;
override PLAN_NORMAL_MAPS: u32 = 1u;
// 1: some material's albedo tables may go over the roughness.
override PLAN_ROUGH_TABLES: u32 = 1u;
// 1: light may go straight on through some surface.
override PLAN_ALPHA: u32 = 1u;
// 1: the lens may be open.
override PLAN_LENS: u32 = 1u;

fn planned(value: u32, plan: u32) -> u32 {
    return select(plan, value, plan == ANY);
}
