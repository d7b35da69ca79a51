//! What everything in the window is drawn with: theme, rows and controls, icons, charts, numbers in words.

pub(super) mod charts;
pub(super) mod icons;
pub(super) mod keys;
pub(super) mod parameter_row;
pub(super) mod start_stop;
pub(super) mod theme;
pub(super) mod tile;
pub(super) mod widgets;
pub(super) mod words;
