//! Messages of topics, for clients that follow them.

use std::collections::HashMap;
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
    new: Option<broadcast::Receiver<Arc<str>>>,
}

impl TopicWatch {
    fn lock(&self) -> MutexGuard<'_, HashMap<String, Watched>> {
        self.watched.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Follows a topic from now on.
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
        drop(watched);
        Ok(Follower { topic: topic.to_owned(), watch: Arc::clone(self), handle: handle.clone(), new: Some(new) })
    }
}

impl Follower {
    /// The next message, as JSON; `Err` is the number of messages that were lost before it. `None` is the end.
    pub(crate) async fn next(&mut self) -> Option<Result<Arc<str>, u64>> {
        match self.new.as_mut()?.recv().await {
            Ok(message) => Some(Ok(message)),
            Err(broadcast::error::RecvError::Lagged(lost)) => Some(Err(lost)),
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

    fn message(&self, sent: &SentMessage) {
        let watched = self.lock();
        let Some(one) = watched.get(&*sent.topic) else { return };
        let message = one.schema.decode(sent.message.bytes());
        let time = sent.message.header().sent.as_secs_f64();
        let shown = json!({"time_s": time, "component": &*sent.component, "message": message.ok()});
        // The last follower may be about to leave.
        let _ = one.new.send(shown.to_string().into());
    }
}
