//! `saoms lsp`: answers editors, by the Language Server Protocol 3.17 on standard input and output.
//!
//! One thread reads, one answers, one checks. Answers come from [`saoms_tools::editor`]; diagnostics come from the
//! loader and the checker, as `saoms check` has them. This module holds the protocol alone: messages, documents,
//! positions in UTF-16.

mod capabilities;
mod check;
mod convert;
mod diagnostics;
mod documents;
mod fixes;
mod fleets;
mod position;
mod registries;
mod requests;
mod rpc;
mod server;
#[cfg(test)]
mod tests;
mod uri;

use std::io::{self, BufReader};
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::sync::mpsc;
use std::thread;

use check::{CheckOptions, Checker};
use registries::Registries;
use server::{Event, Server};

use crate::Exit;
use crate::command::lsp::LspArguments;

pub(crate) fn lsp(arguments: &LspArguments) -> Exit {
    let (events, came) = mpsc::channel();
    let (jobs, asked) = mpsc::channel();
    let registries = Arc::new(Registries::new(arguments.plugins.clone()));
    let newest = Arc::new(AtomicU64::new(0));
    let LspArguments { assume_classes, allow_outside, .. } = *arguments;
    let options = CheckOptions { assume_classes, allow_outside };
    let checker = Checker::new(Arc::clone(&registries), options, Arc::clone(&newest));
    let done = events.clone();
    thread::spawn(move || checker.run(&asked, |outcome| drop(done.send(Event::Checked(outcome)))));
    thread::spawn(move || {
        let mut input = BufReader::new(io::stdin().lock());
        while let Ok(Some(incoming)) = rpc::read(&mut input) {
            if events.send(Event::Incoming(incoming)).is_err() {
                return;
            }
        }
        let _ = events.send(Event::Closed);
    });
    Server::new(io::stdout().lock(), registries, jobs, newest).run(&came)
}
