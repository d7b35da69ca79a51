//! What everything in the window is drawn with: theme, rows and controls, icons, charts, numbers in words.

pub mod charts;
pub mod drag;
pub mod icons;
pub mod keys;
pub mod parameter_row;
pub mod start_stop;
pub mod theme;
pub mod tile;
pub mod widgets;
pub mod words;
