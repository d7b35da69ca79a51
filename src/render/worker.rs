//! (stub until the window lands)
