//! `saoms lsp`: answers editors, by the Language Server Protocol 3.17 on standard input and output.
//!
//! One thread reads, one answers, one checks. Answers and diagnostics come from [`saoms_tools::editor`]. This module
//! holds the protocol alone: messages, documents, positions, and results in its types.

mod capabilities;
mod check;
mod convert;
mod diagnostics;
mod documents;
mod plugins;
mod position;
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

use saoms_tools::editor::{CheckOptions, Checker, ClassCache, Workspace};

use check::check_all;
use server::{Event, Server};

use crate::Exit;
use crate::command::lsp::LspArguments;
use crate::output::{eprint, keep_from_libraries, own};

pub(crate) fn lsp(arguments: &LspArguments) -> Exit {
    // The editor's messages alone are written there, whatever libraries print.
    keep_from_libraries();
    let output = match own() {
        Ok(output) => output,
        Err(error) => {
            eprint(&format!("error: standard output cannot be written: {error}\n"));
            return Exit::Failed;
        }
    };
    let (events, came) = mpsc::channel();
    let (jobs, asked) = mpsc::channel();
    let classes = Arc::new(ClassCache::new(arguments.plugins.clone()));
    let newest = Arc::new(AtomicU64::new(0));
    let LspArguments { assume_classes, allow_outside, .. } = *arguments;
    let options = CheckOptions { assume_classes, allow_outside };
    let checker = Checker::new(Arc::clone(&classes), options);
    let (done, wanted) = (events.clone(), Arc::clone(&newest));
    thread::spawn(move || check_all(checker, &wanted, &asked, |outcome| drop(done.send(Event::Checked(outcome)))));
    thread::spawn(move || {
        let mut input = BufReader::new(io::stdin().lock());
        while let Ok(Some(incoming)) = rpc::read(&mut input) {
            if events.send(Event::Incoming(incoming)).is_err() {
                return;
            }
        }
        let _ = events.send(Event::Closed);
    });
    Server::new(output, Workspace::new(allow_outside), classes, jobs, newest).run(&came)
}
