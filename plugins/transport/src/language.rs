//! What differs from one kind of broker to another.

use std::io::{self, BufRead};

use crate::{Link, Settings};

/// The language of a kind of brokers. A value is what one end has to remember of a connection.
pub trait Language: Sized + Send + 'static {
    /// The kind, as in `an MQTT broker`.
    const BROKER: &'static str;
    /// The language, as in `MQTT`.
    const NAME: &'static str;
    /// The scheme of urls with TLS.
    const WITH_TLS: &'static str;
    /// What is said where a program of the fleet is to be the broker: that it cannot, and what to do.
    const NO_ROUTER: &'static str;
    /// What says that the program is still there.
    const BEAT: &'static [u8];
    /// What a program says last.
    const BYE: &'static [u8];

    /// Says who the program is, and hears whether it may join. `name` is another one at each start.
    ///
    /// # Errors
    /// It may not, or who listens there speaks another language.
    fn join(settings: &Settings, name: &str, from: &mut impl BufRead, to: &Link) -> Result<Self, Ended>;

    /// The longest frame that the broker takes, in bytes.
    fn longest(&self) -> usize;

    /// A message, as it goes to the broker.
    ///
    /// # Errors
    /// The language cannot say it: why.
    fn put(name: &str, message: Message<'_>) -> Result<Vec<u8>, String>;

    /// Asks for keys, under a number of the program's, from 1.
    ///
    /// # Errors
    /// The language cannot say it: why.
    fn subscribe(number: u16, keys: &str) -> Result<Vec<u8>, String>;

    /// Does not want them any more.
    fn unsubscribe(number: u16, keys: &str) -> Vec<u8>;

    /// Hears the next thing that the broker says.
    ///
    /// # Errors
    /// The connection ended, or the broker ends it.
    fn hear(&mut self, name: &str, from: &mut impl BufRead) -> Result<Heard, Ended>;
}

/// A message, with what its sender says beside it.
#[derive(Clone, Copy, Debug)]
pub struct Message<'a> {
    /// Its key.
    pub key: &'a str,
    /// The message.
    pub message: &'a [u8],
    /// What is said beside it.
    pub attachment: &'a [u8],
}

impl Message<'_> {
    /// Its bytes with those of the attachment behind them, which no language of a broker has a place for that is long
    /// enough in each case. How many these are is said in the head of a frame, as `saoms`.
    pub fn write(&self, to: &mut Vec<u8>) {
        to.extend_from_slice(self.message);
        to.extend_from_slice(self.attachment);
    }
}

/// What a broker says.
#[derive(Debug, PartialEq, Eq)]
pub enum Heard {
    /// A message for the program.
    Message {
        /// The subscription that it is for; 0 for all that fit.
        number: u16,
        /// Its key.
        key: String,
        /// Its bytes, with those of the attachment behind them.
        bytes: Vec<u8>,
        /// The length of the attachment.
        attachment: usize,
    },
    /// Nothing of interest.
    Other,
}

/// The reason for the end of a connection, or for none.
#[derive(Debug)]
pub enum Ended {
    /// It broke.
    Broken(io::Error),
    /// The broker does not want the program: why, for people.
    Refused(String),
    /// The broker does not let the program read the keys of the subscription with this number.
    NotRead(u16),
    /// The broker cannot serve the program now, and says why.
    NotNow(String),
    /// The other end says first what no such broker says.
    Foreign(Vec<u8>),
}

impl From<io::Error> for Ended {
    fn from(error: io::Error) -> Ended {
        Ended::Broken(error)
    }
}

impl Ended {
    /// The other end says what the language does not have.
    pub fn malformed(what: &str) -> Ended {
        Ended::Broken(io::Error::new(io::ErrorKind::InvalidData, what))
    }

    /// The broker refuses the account.
    pub fn no_account(settings: &Settings) -> Ended {
        Ended::Refused(match &settings.user {
            Some(user) => format!("the broker refuses user `{user}`: the password is wrong, or it has no such user"),
            None if settings.is_of_fleet => {
                "the broker asks for a user: give `user`, and `password` or `passwordFile`".to_owned()
            }
            None => "the broker asks for a user: give `user` and `password`".to_owned(),
        })
    }

    /// The broker does not let the user do what each program of a network has to.
    pub fn no_right(settings: &Settings) -> Ended {
        let who = who(settings);
        Ended::Refused(format!(
            "the broker does not let {who} send and read what a fleet needs: allow it all that begins with `saoms`"
        ))
    }
}

/// What is said where the broker does not let the user read keys.
pub(crate) fn not_read(settings: &Settings, keys: &str) -> String {
    let who = who(settings);
    match settings.is_of_fleet {
        true => format!(
            "the broker does not let {who} read `{keys}`, which a fleet needs: allow it all that begins with `saoms`"
        ),
        false => format!("the broker does not let {who} read `{keys}`: allow it that"),
    }
}

fn who(settings: &Settings) -> String {
    match &settings.user {
        Some(user) => format!("user `{user}`"),
        None => "a program without a user".to_owned(),
    }
}

/// True if a key is one of these keys, in which `*` is any one part, and `**` at the end any number of them.
pub fn fits(key: &str, keys: &str) -> bool {
    let (mut parts, mut wanted) = (key.split('/'), keys.split('/'));
    loop {
        match (parts.next(), wanted.next()) {
            (_, Some("**")) | (None, None) => return true,
            (Some(part), Some(one)) if one == "*" || one == part => {}
            _ => return false,
        }
    }
}
