//! softfold
fn main() {}
