// Places in the grids that alias tables are laid out in. Twin of src/scene/alias.rs.

struct GridPlace {
    // Row times columns plus column.
    index: u32,
    // Position in the cell, in [0, 1]^2.
    place: vec2f,
}

// The cell of a grid of `size` columns and rows that a place in [0, 1)^2 falls in, and the place inside it.
fn grid_place(xi: vec2f, size: vec2u) -> GridPlace {
    let scaled = xi * vec2f(size);
    let cell = min(vec2u(scaled), size - 1u);
    return GridPlace(cell.y * size.x + cell.x, min(scaled - vec2f(cell), vec2f(1.0)));
}
