//! The program: picks a face, prints the error chain, sets the exit code.

fn main() {}
