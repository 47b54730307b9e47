//! Asking the programs of a network.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use saoms_api::host::{cdr, one_line};
use saoms_core::network::control::{Answer, Ask, Other};
use saoms_core::network::exchange::wire::Alive;
use saoms_core::network::key;
use serde_json::{Value, json};

use super::collected::Collected;
use super::{ACCESS, ALIVE, ANSWERS, Answered, Known, Programs, heading};
use crate::Exit;
use crate::arguments::Format;
use crate::output::{eprint, print, print_json};

/// Time for which answers are waited for.
const PATIENCE: Duration = Duration::from_secs(5);
/// Time without another answer after which no other program is waited for that was not heard.
const SETTLE: Duration = Duration::from_millis(500);
/// Time after which who has not answered is asked again.
pub(super) const AGAIN: Duration = Duration::from_millis(300);
/// Time for which a program counts as known that others know alone, in milliseconds.
const UNHEARD: u64 = 5_000;
/// Time for which a message is waited for at once.
const LOOK: Duration = Duration::from_millis(20);

impl Programs<'_> {
    /// A new request, with its number.
    pub(super) fn new_request(&mut self, method: &str, path: &str, body: &str) -> Ask {
        self.asked += 1;
        let (method, path, body) = (method.to_owned(), path.to_owned(), body.to_owned());
        Ask { asker: self.own, number: self.asked, to: 0, have: 0, method, path, body }
    }

    /// Sends a request to a program, which has sent so many parts of its answer; 0 is all programs.
    pub(super) fn put(&self, ask: &Ask, to: u64, have: u32) {
        let bytes = cdr::encode(&Ask { to, have, ..ask.clone() });
        // What finds no room is sent again.
        let _ = self.session.put(&key::control(self.own), &bytes, &[], true);
    }

    /// The next part of an answer to this request, if one comes soon.
    pub(super) fn next(&mut self, ask: &Ask) -> Option<Answer> {
        let (token, message) = self.inbox.next(LOOK)?;
        match token {
            ALIVE => {
                if let Ok(alive) = cdr::decode::<Alive>(&message) {
                    if alive.leaves {
                        self.known.remove(&alive.program);
                    } else {
                        let known = Known { name: alive.name, heard: Instant::now(), patience: alive.patience };
                        self.known.insert(alive.program, known);
                    }
                }
                None
            }
            ACCESS => {
                self.granted = cdr::decode(&message).ok().or(self.granted.take());
                None
            }
            ANSWERS => {
                let answer = cdr::decode::<Answer>(&message).ok().filter(|answer| answer.number == ask.number)?;
                // One that hangs says nothing itself.
                for Other { program, name } in &answer.others {
                    let known = || Known { name: name.clone(), heard: Instant::now(), patience: UNHEARD };
                    self.known.entry(*program).or_insert_with(known);
                }
                Some(answer)
            }
            _ => None,
        }
    }

    /// True if this program is asked.
    pub(super) fn is_meant(&self, name: &str) -> bool {
        self.only.is_none_or(|only| only == name)
    }

    /// The names of the programs that are there and have not answered.
    pub(super) fn silent(&self, has_answered: impl Fn(&u64) -> bool) -> Vec<String> {
        let silent = self.known.iter().filter(|(program, known)| !has_answered(program) && self.is_meant(&known.name));
        silent.map(|(_, known)| known.name.clone()).collect()
    }

    /// Asks a program, or all that are meant, and waits for the answers. Programs that are there and do not answer are
    /// told on standard error; gives their number, too.
    ///
    /// # Errors
    /// No program answers, which was reported.
    pub(super) fn ask(
        &mut self,
        only: Option<u64>,
        (method, path, body): (&str, &str, &str),
    ) -> Result<(Vec<Answered>, usize), Exit> {
        let ask = self.new_request(method, path, body);
        let mut answers: BTreeMap<u64, (Collected, String)> = BTreeMap::new();
        let (begun, mut news, mut asked_at) = (Instant::now(), Instant::now(), None::<Instant>);
        loop {
            let is_whole = |program: &u64| answers.get(program).is_some_and(|(answer, _)| answer.is_whole);
            let is_open = |program: &u64| !is_whole(program);
            if asked_at.is_none_or(|at| at.elapsed() >= AGAIN) {
                let have = |program: &u64| answers.get(program).map_or(0, |(answer, _)| answer.next);
                match only {
                    Some(program) => self.put(&ask, program, have(&program)),
                    None if asked_at.is_none() && self.only.is_none() => self.put(&ask, 0, 0),
                    None => {
                        let open =
                            self.known.iter().filter(|(program, known)| is_open(program) && self.is_meant(&known.name));
                        open.for_each(|(program, _)| self.put(&ask, *program, have(program)));
                    }
                }
                asked_at = Some(Instant::now());
            }
            let is_complete = match only {
                Some(program) => is_whole(&program),
                None => {
                    // One that was killed may be there again under its name.
                    let named = |name: &str| answers.values().any(|(answer, _)| answer.is_whole && answer.name == name);
                    let mut meant =
                        self.known.iter().filter(|(_, known)| self.is_meant(&known.name) && !named(&known.name));
                    !answers.is_empty()
                        && answers.keys().all(is_whole)
                        && meant.all(|(program, _)| is_whole(program))
                        && news.elapsed() >= SETTLE
                }
            };
            if is_complete || begun.elapsed() >= PATIENCE {
                break;
            }
            if let Some(answer) = self.next(&ask) {
                let (collected, text) = answers.entry(answer.program).or_default();
                collected.take(answer).iter().for_each(|part| text.push_str(part));
                news = Instant::now();
            }
        }
        answers.retain(|_, (answer, _)| answer.is_whole);
        let mut silent = match only {
            Some(_) => Vec::new(),
            None => self.silent(|program| answers.contains_key(program)),
        };
        silent.retain(|name| answers.values().all(|(answer, _)| answer.name != *name));
        let answers = answers.into_iter();
        let answered: Vec<Answered> = answers.map(|(id, (answer, text))| answered(id, &answer, &text)).collect();
        if answered.is_empty() {
            return Err(self.nobody(&silent));
        }
        silent.iter().for_each(|name| eprint(&format!("warning: {} does not answer\n", heading(name))));
        Ok((answered, silent.len()))
    }

    /// Reports that no program answers.
    pub(super) fn nobody(&self, silent: &[String]) -> Exit {
        let url = one_line(self.url).into_owned();
        let own = self
            .user
            .zip(self.granted.as_ref())
            .filter(|(user, granted)| !granted.users.iter().any(|one| one.user == *user && one.controls));
        if let Some((user, _)) = own {
            let user = one_line(user);
            let message = format!(
                "user `{user}` may not control the programs on the network `{url}`\n  = help: write \
                 `{user}: controls` into the `access` of the broker"
            );
            return self.fleet.refuse(&message, Exit::WrongInput);
        }
        let within = PATIENCE.as_secs();
        let names: Vec<String> = silent.iter().map(|name| format!("`{}`", one_line(name))).collect();
        let message = match (self.only, names.as_slice()) {
            (Some(only), []) => {
                let known: Vec<String> = self.known.values().map(|one| format!("`{}`", one_line(&one.name))).collect();
                let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
                format!("program `{}` is not on the network `{url}`\n  = help: these are: {known}", one_line(only))
            }
            (None, []) => format!(
                "no program on the network `{url}` answers within {within} s\n  = help: start one with `saoms run`, or correct \
                 the url"
            ),
            (_, names) => format!(
                "no program on the network `{url}` answers within {within} s; there is {}\n  = help: they are stopped, or \
                 speak another version",
                names.join(", ")
            ),
        };
        self.fleet.refuse(&message, Exit::WrongInput)
    }

    /// The answers of all programs that do not refuse, as far as they are to be kept, and whether a program that is
    /// there did not answer.
    ///
    /// # Errors
    /// No program answers, or all refuse, which was reported.
    pub(in crate::command::control) fn answers(
        &mut self,
        asked: (&str, &str, &str),
        keep: impl Fn(&mut Value) -> bool,
    ) -> Result<(Vec<(String, Value)>, bool), Exit> {
        let (answered, silent) = self.ask(None, asked)?;
        let mut shown = Vec::new();
        let mut refusal = None;
        for Answered { name, result, .. } in answered {
            match result {
                Ok(mut answer) => {
                    if keep(&mut answer) {
                        shown.push((name, answer));
                    }
                }
                Err(why) => _ = refusal.get_or_insert(why),
            }
        }
        if let Some(why) = refusal.filter(|_| shown.is_empty()) {
            return Err(self.fleet.refuse(&why, Exit::WrongInput));
        }
        shown.sort_by(|one, other| one.0.cmp(&other.0));
        Ok((shown, silent > 0))
    }

    /// Shows what programs answered.
    pub(in crate::command::control) fn print(&self, shown: &[(String, Value)], words: impl Fn(&Value) -> String) {
        match self.fleet.format {
            Format::Human => {
                let each = shown.iter().map(|(name, answer)| {
                    let words = words(answer);
                    let gap = if words.trim_end().contains('\n') { "\n" } else { " " };
                    format!("{}:{gap}{}\n", heading(name), words.trim_end())
                });
                print(&each.collect::<Vec<_>>().join(""));
            }
            Format::Json => {
                let each = shown.iter().map(|(name, answer)| json!({"program": name, "answer": answer}));
                print_json(&json!({"programs": each.collect::<Vec<_>>()}));
            }
        }
    }

    /// Gives an order to the first program that does not refuse it, and its answer. Where all refuse, all reasons are
    /// reported.
    pub(in crate::command::control) fn give(&mut self, asked: (&str, &str, &str)) -> Result<(String, Value), Exit> {
        let (mut programs, _) = self.ask(None, ("GET", "/v1/fleet", ""))?;
        programs.sort_by(|one, other| one.name.cmp(&other.name));
        let mut reasons: Vec<String> = Vec::new();
        for Answered { id, name, .. } in programs {
            let (answered, _) = self.ask(Some(id), asked)?;
            match answered.into_iter().next().map(|one| one.result) {
                Some(Ok(answer)) => return Ok((name, answer)),
                Some(Err(why)) => reasons.push(format!("{}: {why}", heading(&name))),
                None => {}
            }
        }
        reasons.dedup();
        Err(self.fleet.refuse(&reasons.join("\nerror: "), Exit::WrongInput))
    }
}

/// The answer of a program.
fn answered(id: u64, answer: &Collected, text: &str) -> Answered {
    let value = serde_json::from_str::<Value>(text).unwrap_or(Value::Null);
    let result = match answer.is_accepted() {
        true => Ok(value),
        false => Err(value["error"].as_str().map_or_else(|| format!("status {}", answer.status), str::to_owned)),
    };
    Answered { name: answer.name.clone(), id, result }
}
