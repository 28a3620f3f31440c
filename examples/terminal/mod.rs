//! What the examples have in common on a terminal: the ranges of their options, where their output
//! goes, how they end.
//!
//! Exit codes: 0 done; 2 the command line is wrong (by clap); 1 anything else that went wrong.

#![allow(dead_code, unused_imports, reason = "each example uses some of it")]

mod escape;
mod number;
mod options;
mod product;
mod progress;
mod speech;

pub(crate) use escape::{name, quoted};
pub(crate) use number::shortest;
pub(crate) use options::{Threads, bodies, margin, number, parse, refuse, whole, within};
pub(crate) use product::{Product, is_same_file, is_source};
pub(crate) use progress::Progress;
pub(crate) use speech::{StandardOutput, complain, exit_code, tell_unused};
