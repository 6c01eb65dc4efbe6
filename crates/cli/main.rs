//! The `pipeline` command: arguments in, reports and exit codes out.
//!
//! One file a command, each with a function `execute`. What commands share stands in its own file: the options
//! (`args`, `parse`), the application with its scene (`session`), progress, interruption, profiling, and the one place
//! that turns outcomes into reports and exit codes (`exit`). Nothing here knows how an image is made.
//!
//! Data goes to standard output, text for people to standard error. A reader that goes away early is no error.

mod args;
mod audit;
mod audit_map;
mod audit_text;
mod cache_session;
mod check;
mod compare;
mod compare_text;
mod exit;
mod explain;
mod flatten;
mod graph;
mod interrupt;
mod number;
mod outputs;
mod parse;
mod photon_colour;
mod photon_ply;
mod photons;
mod point_cloud;
mod point_colour;
mod point_picture;
mod profile;
mod profiling;
mod progress;
mod record_colour;
mod record_ply;
mod records;
mod run;
mod schema;
mod session;
mod stages;
mod summary;
mod terminal;

use args::{Cli, Command};
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let ended = match Cli::parse().command {
        Command::Run(options) => run::execute(&options),
        Command::Check(options) => check::execute(&options),
        Command::Flatten(options) => flatten::execute(&options),
        Command::Explain(options) => explain::execute(&options),
        Command::Schema(options) => schema::execute(&options),
        Command::Stages(options) => stages::execute(&options),
        Command::Profile(options) => profile::execute(&options),
        Command::Photons(options) => photons::execute(&options),
        Command::Records(options) => records::execute(&options),
        Command::Compare(options) => compare::execute(&options),
        Command::Audit(options) => audit::execute(&options),
    };
    exit::conclude(ended)
}
