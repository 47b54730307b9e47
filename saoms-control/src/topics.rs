//! Messages of topics, for clients that follow them.

use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use saoms_core::observe::{Interest, Observer, SentMessage};
use saoms_core::schedule::{Handle, InjectError};
use saoms_lang::schema::Schema;
use serde_json::json;
use tokio::sync::broadcast;

/// Number of messages that may wait for a client.
const WAITING: usize = 1024;

/// An observer that passes the messages of topics to clients. A topic that nobody follows costs nothing. A client that
/// is slower than its topic loses messages, and is told how many.
#[derive(Debug, Default)]
pub struct TopicWatch {
    watched: Mutex<HashMap<String, Watched>>,
}

#[derive(Debug)]
struct Watched {
    schema: Schema,
    new: broadcast::Sender<Arc<str>>,
}

/// A client's place in a topic. The topic is followed until the last one is dropped.
pub(crate) struct Follower {
    topic: String,
    watch: Arc<TopicWatch>,
    handle: Handle,
    /// What the topic retained before.
    retained: VecDeque<Arc<str>>,
    new: Option<broadcast::Receiver<Arc<str>>>,
}

/// What a follower gets.
pub(crate) enum Followed {
    /// A message in JSON that the topic retained before.
    Retained(Arc<str>),
    /// A new message in JSON.
    Sent(Arc<str>),
    /// Number of messages that were lost here.
    Lost(u64),
}

impl TopicWatch {
    fn lock(&self) -> MutexGuard<'_, HashMap<String, Watched>> {
        self.watched.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Follows a topic from now on, after what it retains.
    ///
    /// # Errors
    /// The fleet has no such topic.
    pub(crate) fn follow(self: &Arc<Self>, topic: &str, handle: &Handle) -> Result<Follower, InjectError> {
        let mut watched = self.lock();
        let new = match watched.get(topic) {
            Some(one) => one.new.subscribe(),
            None => {
                let schema = handle.watch(topic, &(Arc::clone(self) as Arc<dyn Observer>), true)?;
                let (new, first) = broadcast::channel(WAITING);
                watched.insert(topic.to_owned(), Watched { schema, new });
                first
            }
        };
        let schema = watched.get(topic).map(|one| one.schema.clone());
        drop(watched);
        let topic = topic.to_owned();
        let mut follower = Follower {
            topic,
            watch: Arc::clone(self),
            handle: handle.clone(),
            retained: VecDeque::new(),
            new: Some(new),
        };
        if let Some(schema) = schema {
            follower.retained = handle.retained(&follower.topic)?.iter().map(|sent| json(sent, &schema)).collect();
        }
        Ok(follower)
    }
}

impl Follower {
    /// What comes next; `None` is the end.
    pub(crate) async fn next(&mut self) -> Option<Followed> {
        if let Some(message) = self.retained.pop_front() {
            return Some(Followed::Retained(message));
        }
        match self.new.as_mut()?.recv().await {
            Ok(message) => Some(Followed::Sent(message)),
            Err(broadcast::error::RecvError::Lagged(lost)) => Some(Followed::Lost(lost)),
            Err(broadcast::error::RecvError::Closed) => None,
        }
    }
}

impl Drop for Follower {
    fn drop(&mut self) {
        let mut watched = self.watch.lock();
        drop(self.new.take());
        if watched.get(&self.topic).is_some_and(|one| one.new.receiver_count() == 0) {
            watched.remove(&self.topic);
            // A topic that is gone is followed by nobody.
            let _ = self.handle.watch(&self.topic, &(Arc::clone(&self.watch) as Arc<dyn Observer>), false);
        }
    }
}

impl Observer for TopicWatch {
    fn interest(&self) -> Interest {
        Interest::NONE
    }

    fn hears_others(&self) -> bool {
        true
    }

    fn message(&self, sent: &SentMessage) {
        let watched = self.lock();
        let Some(one) = watched.get(&*sent.topic) else { return };
        // The last follower may be about to leave.
        let _ = one.new.send(json(sent, &one.schema));
    }
}

/// A message as clients get it.
fn json(sent: &SentMessage, schema: &Schema) -> Arc<str> {
    let message = schema.decode(sent.message.bytes());
    let time = sent.message.header().sent.as_secs_f64();
    json!({"time_s": time, "component": &*sent.component, "message": message.ok()}).to_string().into()
}
