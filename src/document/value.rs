//! The value of a parameter.

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number in the parameter's unit.
    Number(f32),
    /// Linear RGB.
    Color([f32; 3]),
    /// The name of one of the parameter's choices.
    Choice(&'static str),
    /// On or off.
    Toggle(bool),
    /// A number for each colour channel.
    Triple([f32; 3]),
    /// A curve's points (ξ, D).
    Curve(Vec<[f32; 2]>),
}
