//! Continuations of an unfinished fault, which editors offer.

use saoms_api::event::fault::{FAULTS, LASTING};

use super::Continuation;
use super::line::UNITS;

/// Possible continuations of a fault that begins with this word, behind which `rest` is written; none if it is complete
/// or wrong.
pub(super) fn follow(first: &str, rest: &str) -> Vec<Continuation> {
    let spaced = rest.replace(',', " , ");
    let mut words = Words { all: spaced.split_whitespace().collect(), at: 0 };
    words.fault(first).err().unwrap_or_default()
}

/// What is expected in place of a word that is missing.
type Expected = Vec<Continuation>;

struct Words<'t> {
    all: Vec<&'t str>,
    at: usize,
}

impl<'t> Words<'t> {
    fn peek(&self) -> Option<&'t str> {
        self.all.get(self.at).copied()
    }

    /// The next word, or what is expected there.
    fn next(&mut self, expected: impl FnOnce() -> Expected) -> Result<&'t str, Expected> {
        let word = self.peek().ok_or_else(expected)?;
        self.at += 1;
        Ok(word)
    }

    fn take(&mut self, is_it: impl FnOnce(&str) -> bool) -> bool {
        let found = self.peek().is_some_and(is_it);
        self.at += usize::from(found);
        found
    }

    /// Nothing continues a line with another word.
    fn expect(&mut self, word: &'static str) -> Result<(), Expected> {
        let found = self.next(|| vec![Continuation::Word(word)])?;
        if found == word { Ok(()) } else { Err(Vec::new()) }
    }

    fn fault(&mut self, first: &str) -> Result<(), Expected> {
        let word = match first {
            LASTING => {
                self.time()?;
                // `fail` and `crash` happen once.
                let lasts = |word: &&str| !["fail", "crash"].contains(word);
                self.next(|| FAULTS.into_iter().filter(lasts).map(Continuation::Word).collect())?
            }
            word => word,
        };
        match word {
            "lose" | "violate" | "duplicate" => self.rate()?,
            "jitter" => self.time()?,
            "delay" => {
                self.time()?;
                let is_range = self.peek() == Some("to")
                    && self.all.get(self.at + 1).is_none_or(|next| next.starts_with(|one: char| one.is_ascii_digit()));
                if is_range && self.all.len() > self.at + 1 {
                    self.at += 1;
                    self.time()?;
                } else if is_range {
                    // The greater time, or the components that read.
                    return Err(vec![Continuation::Duration, Continuation::Component]);
                }
            }
            "reorder" => {
                self.rate()?;
                self.expect("by")?;
                self.time()?;
            }
            "cut" | "part" => {
                self.names()?;
                self.expect("from")?;
                self.names()?;
                return self.links(&["on"]);
            }
            "stall" | "fail" => return self.names(),
            "crash" => {
                self.names()?;
                self.expect("restart")?;
                return self.time();
            }
            "drift" => {
                self.names()?;
                return self.rate();
            }
            _ => return Err(Vec::new()),
        }
        self.links(&["on", "from", "to"])
    }

    /// Which messages: each of these words once, in this order.
    fn links(&mut self, mut left: &'static [&'static str]) -> Result<(), Expected> {
        while !left.is_empty() {
            let word = self.next(|| left.iter().copied().map(Continuation::Word).collect())?;
            let Some(place) = left.iter().position(|one| *one == word) else { return Err(Vec::new()) };
            left = &left[place + 1..];
            match word {
                "on" => _ = self.next(|| vec![Continuation::Topic])?,
                _ => self.names()?,
            }
        }
        Ok(())
    }

    /// Components, with commas between them.
    fn names(&mut self) -> Result<(), Expected> {
        loop {
            self.next(|| vec![Continuation::Component])?;
            if !self.take(|word| word == ",") {
                return Ok(());
            }
        }
    }

    /// A time; a blank may separate the number from its unit.
    fn time(&mut self) -> Result<(), Expected> {
        self.next(|| vec![Continuation::Duration])?;
        self.take(|word| UNITS.contains(&word));
        Ok(())
    }

    /// A rate; a blank may separate the number from `%`.
    fn rate(&mut self) -> Result<(), Expected> {
        self.next(|| vec![Continuation::Rate])?;
        self.take(|word| word == "%");
        Ok(())
    }
}
