//! A session: a server, or a client of one. What both know of topics is the same.

use std::collections::{BTreeMap, HashMap, VecDeque};
use std::sync::Arc;

use saoms_transport::{Failure, Program, Topic, TopicTransport};

use crate::client::Client;
use crate::form::Form;
use crate::server::Server;
use crate::settings::Settings;

/// Messages that the program has published and that may come back, at most.
const MOST_OWN: usize = 1024;

/// A session of a network.
pub(crate) enum Session {
    Server(Server),
    Client(Client),
}

/// The topics of the program.
#[derive(Default)]
pub(crate) struct Topics {
    /// By their names.
    pub(crate) all: BTreeMap<String, Known>,
    /// The names of those that are published, by their tokens.
    published: HashMap<u64, String>,
}

/// A topic of the program.
pub(crate) struct Known {
    pub(crate) form: Arc<Form>,
    /// The token of the program's subscription, if it reads the topic.
    pub(crate) read: Option<u64>,
    pub(crate) is_published: bool,
    pub(crate) is_state: bool,
    /// Of a state topic, the newest messages in JSON by their numbers.
    pub(crate) states: BTreeMap<u64, Arc<str>>,
    /// Messages of the program that the server may send back, if it reads the topic, too.
    own: VecDeque<Vec<u8>>,
}

impl Topics {
    /// Adds a topic that the program uses.
    fn known(&mut self, topic: &Topic) -> Result<&mut Known, Failure> {
        let form = Form::of(topic)?;
        let known = self.all.entry(topic.name.clone()).or_insert_with(|| Known {
            form: Arc::new(form),
            read: None,
            is_published: false,
            is_state: topic.state,
            states: BTreeMap::new(),
            own: VecDeque::new(),
        });
        Ok(known)
    }

    pub(crate) fn advertise(&mut self, topic: &Topic, token: u64) -> Result<(), Failure> {
        self.known(topic)?.is_published = true;
        self.published.insert(token, topic.name.clone());
        Ok(())
    }

    pub(crate) fn subscribe(&mut self, topic: &Topic, token: u64) -> Result<(), Failure> {
        self.known(topic)?.read = Some(token);
        Ok(())
    }

    /// The name and the type of a topic that is published.
    pub(crate) fn published(&self, token: u64) -> Result<(String, Arc<Form>), Failure> {
        let name = self.published.get(&token).ok_or_else(|| Failure::failed("the topic was not advertised"))?;
        let known = self.all.get(name).ok_or_else(|| Failure::failed("the topic is not known"))?;
        Ok((name.clone(), Arc::clone(&known.form)))
    }
}

impl Known {
    /// Keeps the newest message of a state.
    pub(crate) fn keep(&mut self, of: u64, message: &Arc<str>) {
        if self.is_state {
            self.states.insert(of, Arc::clone(message));
        }
    }

    /// Remembers a message that a server may send back.
    pub(crate) fn note_own(&mut self, message: &[u8]) {
        if self.read.is_some() {
            self.own.push_back(message.to_vec());
            if self.own.len() > MOST_OWN {
                self.own.pop_front();
            }
        }
    }

    /// True, once, for a message that the program has published.
    pub(crate) fn is_own(&mut self, message: &[u8]) -> bool {
        let place = self.own.iter().position(|own| own == message);
        place.is_some_and(|place| self.own.remove(place).is_some())
    }
}

impl TopicTransport for Session {
    fn open(settings: &str, program: Program) -> Result<Self, Failure> {
        let settings = Settings::read(settings)?;
        if let Some((_, text)) = settings.judge().into_iter().next() {
            return Err(Failure::failed(text));
        }
        Ok(match settings.listen {
            true => Session::Server(Server::open(settings.address(), program)?),
            false => Session::Client(Client::open(settings.address(), program)?),
        })
    }

    fn judge(settings: &str) -> Result<Vec<(&'static str, String)>, Failure> {
        Ok(Settings::read(settings)?.judge())
    }

    fn advertise(&self, topic: Topic, token: u64) -> Result<(), Failure> {
        match self {
            Session::Server(server) => server.advertise(&topic, token),
            Session::Client(client) => client.advertise(&topic, token),
        }
    }

    fn publish(&self, token: u64, of: u64, message: &[u8]) -> Result<(), Failure> {
        match self {
            Session::Server(server) => server.publish(token, of, message),
            Session::Client(client) => client.publish(token, of, message),
        }
    }

    fn subscribe(&self, topic: Topic, token: u64) -> Result<(), Failure> {
        match self {
            Session::Server(server) => server.subscribe(&topic, token),
            Session::Client(client) => client.subscribe(&topic, token),
        }
    }

    fn close(self) {
        match self {
            Session::Server(server) => server.close(),
            Session::Client(client) => client.close(),
        }
    }
}
