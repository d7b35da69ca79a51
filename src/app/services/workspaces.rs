//! What is known of workspaces without the panels: names, and changes.

/// The workspace at the start: presets, material, light and camera around a large viewport.
pub const LOOK: &str = "Look";
/// The workspace of effects, races, checks, samples and errors.
pub const MEASURE: &str = "Measure";
/// A change to the workspaces.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// Shows the workspace of this name.
    Use(String),
    /// Keeps the panels as they are under this name, and shows that workspace.
    Save(String),
    /// Removes the user's workspace of this name.
    Remove(String),
}

/// Whether the workspace is one of the program's.
pub fn is_built_in(name: &str) -> bool {
    [LOOK, MEASURE].contains(&name)
}
