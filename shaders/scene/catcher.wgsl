// Reference light of the shadow catcher: the light on its plane without objects. Twin of src/scene/catcher.rs.
#import "scene/layout"

// A place in the table along an axis: the node before it, and how far it is behind that.
struct CatcherNode {
    number: u32,
    behind: f32,
}

fn catcher_node(along: f32, side: u32) -> CatcherNode {
    let away = min(abs(along) / CATCHER_HALF_SIDE, 1.0);
    let bent = away * (1.0 + CATCHER_BEND) / (away + CATCHER_BEND);
    let place = (select(bent, -bent, along < 0.0) * 0.5 + 0.5) * (f32(side) - 1.0);
    let low = floor(place);
    return CatcherNode(u32(low), place - low);
}

// Radiance of a white diffuse plane at a position, lit by all lights without occluders.
fn catcher_light(table: u32, position: vec3f) -> vec3f {
    let side = u32(table_numbers(table, 0u).x);
    let across = catcher_node(position.x, side);
    let down = catcher_node(position.z, side);
    // A loop over the surrounding nodes with weight, so that the code to load one is in the kernel once.
    var sum = vec3f();
    for (var node = 0u; node < select(2u, 4u, down.behind > 0.0); node++) {
        let is_right = (node & 1u) != 0u;
        let is_lower = node > 1u;
        let share = select(1.0 - across.behind, across.behind, is_right) * select(1.0 - down.behind, down.behind, is_lower);
        let row = min(down.number + u32(is_lower), side - 1u);
        sum += table_numbers(table, 1u + row * side + min(across.number + u32(is_right), side - 1u)).xyz * share;
    }
    return sum;
}

// Reflectance of the plane at a cosine, in [0, 1] (Schlick 1994, eq. 15).
fn catcher_reflectance(table: u32, cosine: f32) -> f32 {
    let away = saturate(1.0 - cosine);
    let squared = away * away;
    return table_numbers(table, 0u).y * (CATCHER_REFLECTANCE + (1.0 - CATCHER_REFLECTANCE) * squared * squared * away);
}
