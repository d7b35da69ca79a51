//! What the window offers to those who are new to it.

/// What is still to be offered.
#[derive(Clone, Copy, Debug)]
pub(in crate::app) struct Offers {
    /// How many of the hints for new users are over.
    pub(in crate::app) hints_seen: usize,
    /// The window may offer to download what it lacks.
    pub(in crate::app) offers_downloads: bool,
}
