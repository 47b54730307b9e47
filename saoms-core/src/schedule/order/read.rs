use std::ops::Range;
use std::time::Duration;

use saoms_api::Time;
use saoms_api::event::ORDERS;
use saoms_api::extension::LineFault;
use saoms_api::host::parse_duration;
use serde_json::{Deserializer, Value};

use super::Order;

/// An order with its time.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedOrder {
    /// Time at which it takes effect, in the time of the run; `None` is the next instant.
    pub at: Option<Time>,
    /// The order.
    pub order: Order,
}

const COMPONENT: &str = "the path of a component";

impl Order {
    /// Reads a line; `None` if it is no order: its first word, after `at` and a time, is none of one.
    ///
    /// # Errors
    /// What is wrong with the order, at its place.
    pub fn read(line: &str) -> Option<Result<TimedOrder, LineFault>> {
        let mut words = Words { line, at: 0 };
        let mut first = words.next().unwrap_or_default();
        let time = (first == "at" || first == "from").then(|| {
            let start = words.next().unwrap_or_default();
            first = words.next().unwrap_or_default();
            start
        });
        if !ORDERS.contains(&first) {
            return None;
        }
        Some(read(line, first, words, time))
    }
}

fn read(line: &str, word: &str, mut words: Words<'_>, time: Option<&str>) -> Result<TimedOrder, LineFault> {
    if line.trim_start().starts_with("from") {
        return Err(
            LineFault::new(words.bytes(line.trim_start().split_at(4).0), "an order is carried out once").instead("at")
        );
    }
    let at = time.map(|time| {
        let after = parse_duration(time).map_err(|message| LineFault::new(words.bytes(time), message))?;
        Ok(Time::START + after)
    });
    let order = match word {
        "start" => {
            let component = words.component()?;
            let lasting = words.take("for").then(|| words.duration()).transpose()?;
            Order::Start { component, lasting }
        }
        "stop" => Order::Stop { component: words.component()? },
        "set" => {
            let component = words.component()?;
            let (property, value) = words.assignment()?;
            return Ok(TimedOrder { at: at.transpose()?, order: Order::Set { component, property, value } });
        }
        "estop" => {
            let (components, by) = words.stopped()?;
            Order::EmergencyStop { components, by }
        }
        "release" => {
            let (components, by) = words.stopped()?;
            Order::Release { components, by }
        }
        "call" => words.call()?,
        "publish" => {
            let topic = words.expected("a topic")?.to_owned();
            Order::Publish { topic, message: words.json("a message in JSON")? }
        }
        _ => return Err(LineFault::new(words.bytes(word), format!("`{word}` is not an order"))),
    };
    words.end()?;
    Ok(TimedOrder { at: at.transpose()?, order })
}

/// The rest of a line.
struct Words<'l> {
    line: &'l str,
    at: usize,
}

impl<'l> Words<'l> {
    fn rest(&mut self) -> &'l str {
        let rest = &self.line[self.at..];
        let trimmed = rest.trim_start();
        self.at += rest.len() - trimmed.len();
        trimmed
    }

    fn next(&mut self) -> Option<&'l str> {
        let rest = self.rest();
        let word = &rest[..rest.find(char::is_whitespace).unwrap_or(rest.len())];
        self.at += word.len();
        (!word.is_empty()).then_some(word)
    }

    fn take(&mut self, word: &str) -> bool {
        let before = self.at;
        let is_it = self.next() == Some(word);
        if !is_it {
            self.at = before;
        }
        is_it
    }

    /// The bytes of a part of the line.
    fn bytes(&self, part: &str) -> Range<usize> {
        let start = (part.as_ptr() as usize).saturating_sub(self.line.as_ptr() as usize).min(self.line.len());
        start..(start + part.len()).min(self.line.len())
    }

    fn expected(&mut self, what: &str) -> Result<&'l str, LineFault> {
        let end = self.line.trim_end().len();
        self.next().ok_or_else(|| LineFault::new(end..end, format!("found the end of the line, expected {what}")))
    }

    fn component(&mut self) -> Result<String, LineFault> {
        let word = self.expected(COMPONENT)?;
        match word.trim_end_matches(';') {
            path if path == word => Ok(word.to_owned()),
            _ => Err(LineFault::new(self.bytes(word), "found `;`: write each order on a line of its own")),
        }
    }

    fn duration(&mut self) -> Result<Duration, LineFault> {
        let word = self.expected("a time, such as `10s`")?;
        parse_duration(word).map_err(|message| LineFault::new(self.bytes(word), message))
    }

    /// `PROPERTY=VALUE`, where the value is the rest of the line, or a text in the quotes of JSON.
    fn assignment(&mut self) -> Result<(String, String), LineFault> {
        let rest = self.rest();
        let Some((name, value)) = rest.split_once('=').filter(|(name, _)| !name.contains(char::is_whitespace)) else {
            let word = self.expected("`PROPERTY=VALUE`")?;
            return Err(LineFault::new(self.bytes(word), format!("found `{word}`, expected `PROPERTY=VALUE`")));
        };
        if name.is_empty() {
            return Err(LineFault::new(self.bytes(rest), "found no property before `=`"));
        }
        self.at += name.len() + 1;
        if value.starts_with('"') {
            let text = self.json("a text in quotes")?;
            self.end()?;
            return Ok((name.to_owned(), text.as_str().unwrap_or_default().to_owned()));
        }
        self.at = self.line.len();
        Ok((name.to_owned(), value.trim().to_owned()))
    }

    /// `COMPONENT... by NAME`
    fn stopped(&mut self) -> Result<(Vec<String>, Option<String>), LineFault> {
        let mut components = Vec::new();
        while !self.is_over() {
            if self.take("by") {
                return Ok((components, Some(self.expected("a name after `by`")?.to_owned())));
            }
            components.push(self.component()?);
        }
        Ok((components, None))
    }

    /// `COMPONENT.OPERATION ARGUMENT=VALUE...`
    fn call(&mut self) -> Result<Order, LineFault> {
        let word = self.expected("a component and its operation, such as `Gps.where`")?;
        let Some((component, operation)) =
            word.rsplit_once('.').filter(|(one, two)| !one.is_empty() && !two.is_empty())
        else {
            let message = format!("found `{word}`, expected a component and its operation, such as `Gps.where`");
            return Err(LineFault::new(self.bytes(word), message));
        };
        let (component, operation) = (component.to_owned(), operation.to_owned());
        let mut arguments = Vec::new();
        while !self.is_over() {
            let rest = self.rest();
            let named =
                rest.split_once('=').filter(|(name, _)| !name.is_empty() && !name.contains(char::is_whitespace));
            let Some((name, _)) = named else {
                let word = self.expected("`ARGUMENT=VALUE`")?;
                return Err(LineFault::new(self.bytes(word), format!("found `{word}`, expected `ARGUMENT=VALUE`")));
            };
            self.at += name.len() + 1;
            arguments.push((name.to_owned(), self.value(name)?));
        }
        Ok(Order::Call { component, operation, arguments })
    }

    /// A value in JSON, or else a word.
    fn value(&mut self, name: &str) -> Result<Value, LineFault> {
        let rest = &self.line[self.at..];
        if rest.starts_with(['"', '[', '{']) {
            return self.json(&format!("a value of `{name}` in JSON"));
        }
        let word = &rest[..rest.find(char::is_whitespace).unwrap_or(rest.len())];
        self.at += word.len();
        Ok(serde_json::from_str(word).unwrap_or_else(|_| Value::from(word)))
    }

    /// A value in JSON, which may have blanks.
    fn json(&mut self, what: &str) -> Result<Value, LineFault> {
        let rest = self.rest();
        let mut values = Deserializer::from_str(rest).into_iter::<Value>();
        match values.next() {
            Some(Ok(value)) => {
                self.at += values.byte_offset();
                Ok(value)
            }
            Some(Err(error)) => {
                Err(LineFault::new(self.at..self.line.trim_end().len(), format!("expected {what}: {error}")))
            }
            None => self.expected(what).map(Value::from),
        }
    }

    fn is_over(&mut self) -> bool {
        let rest = self.rest();
        rest.is_empty() || rest.starts_with('#')
    }

    fn end(&mut self) -> Result<(), LineFault> {
        if self.is_over() {
            return Ok(());
        }
        let rest = self.rest().trim_end();
        let message = match rest.starts_with(';') {
            true => "found `;`: write each order on a line of its own".to_owned(),
            false => format!("found `{rest}`, expected the end of the line"),
        };
        Err(LineFault::new(self.bytes(rest), message))
    }
}
