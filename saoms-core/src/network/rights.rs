//! What the user of this program may do on a network, and what its components do without a right to: a router drops
//! that without a word.

use std::collections::BTreeSet;
use std::sync::Arc;

use saoms_api::Message;
use saoms_api::extension::{Access, Topics};

/// All topics.
const ALL: &str = "*";

/// What the router says about the rights of all users.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/Granted")]
pub struct Granted {
    /// The rights of each user.
    pub users: Vec<UserRights>,
}

/// The rights of a user: topics, or `*` for all.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(name = "saoms_msgs/msg/UserRights")]
pub struct UserRights {
    /// The user.
    pub user: String,
    /// The topics that the components of the user may read.
    pub reads: Vec<String>,
    /// The topics that they may publish.
    pub writes: Vec<String>,
    /// True if the components of the user may call those of other programs, and answer their calls.
    pub calls: bool,
    /// True if the user may control the programs.
    pub controls: bool,
}

/// What a router lets a user do: what its class says of the user, with what the components of the nodes that the user
/// runs do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grant {
    /// Topics and control, those of these components among them.
    pub access: Access,
    /// True if the programs of the user may call components of others, and answer their calls.
    pub calls: bool,
}

impl Grant {
    /// What a user may do with this access who runs nodes whose components call others, or are called, or who does not.
    /// Who may read and publish everything may call, too.
    pub fn new(access: Access, runs_calls: bool) -> Grant {
        let calls = runs_calls || access.reads == Topics::All && access.writes == Topics::All;
        Grant { access, calls }
    }
}

impl Granted {
    /// What a router says that grants this.
    pub fn of(grants: &[Grant]) -> Granted {
        let names = |topics: &Topics| match topics {
            Topics::All => vec![ALL.to_owned()],
            Topics::Some(names) => names.clone(),
        };
        let of_user = |Grant { access, calls }: &Grant| UserRights {
            user: access.user.clone(),
            reads: names(&access.reads),
            writes: names(&access.writes),
            calls: *calls,
            controls: access.controls,
        };
        Granted { users: grants.iter().map(of_user).collect() }
    }
}

/// The rights of this program on a network, and what it does there.
#[derive(Debug)]
pub(super) struct Rights {
    url: String,
    user: String,
    /// What the router has said; `None` where it has not, or grants everything.
    known: Option<UserRights>,
    reads: BTreeSet<Arc<str>>,
    writes: BTreeSet<(Arc<str>, Arc<str>)>,
    /// What was told already.
    told: BTreeSet<String>,
}

impl Rights {
    /// Those of a user at a url.
    pub(super) fn new(url: String, user: String) -> Rights {
        Rights { url, user, known: None, reads: BTreeSet::new(), writes: BTreeSet::new(), told: BTreeSet::new() }
    }

    /// Components read a topic. Gives what is to be told.
    pub(super) fn read(&mut self, topic: &Arc<str>, readers: &[String]) -> Option<String> {
        self.reads.insert(Arc::clone(topic));
        self.judge_read(topic, readers)
    }

    /// A component publishes on a topic. Gives what is to be told.
    pub(super) fn write(&mut self, topic: &Arc<str>, component: &Arc<str>) -> Option<String> {
        let way = (Arc::clone(topic), Arc::clone(component));
        if self.writes.contains(&way) {
            return None;
        }
        self.writes.insert(way);
        self.judge_write(topic, component)
    }

    /// A component calls one of another program. Gives what is to be told.
    pub(super) fn call(&mut self, component: &str) -> Option<String> {
        let own = self.known.as_ref()?;
        let what = format!("component `{component}` may not call components of other programs");
        if own.calls || !self.told.insert(what.clone()) {
            return None;
        }
        Some(format!(
            "{what} over the network `{}` as user `{}`: that takes the right to all topics, or to run a node that \
             calls others; write `reads *; writes *` or `runs` and the node in its `access`",
            self.url, self.user
        ))
    }

    /// The router says what users may do. Gives what is to be told; `readers` are the components that read a topic.
    pub(super) fn hear(&mut self, granted: &Granted, readers: impl Fn(&str) -> Vec<String>) -> Vec<String> {
        let own = granted.users.iter().find(|one| one.user == self.user).cloned();
        let own = own.unwrap_or_else(|| UserRights { user: self.user.clone(), ..UserRights::default() });
        if self.known.as_ref() == Some(&own) {
            return Vec::new();
        }
        self.known = Some(own);
        self.told.clear();
        let (reads, writes) = (self.reads.clone(), self.writes.clone());
        let mut all: Vec<String> = reads.iter().filter_map(|topic| self.judge_read(topic, &readers(topic))).collect();
        all.extend(writes.iter().filter_map(|(topic, component)| self.judge_write(topic, component)));
        all
    }

    fn judge_read(&mut self, topic: &str, readers: &[String]) -> Option<String> {
        let own = self.known.as_ref()?;
        let may = |names: &[String]| names.iter().any(|name| name == ALL || name == topic);
        if may(&own.reads) {
            return None;
        }
        let who = match readers {
            [] => "the program".to_owned(),
            [one] => format!("component `{one}`"),
            [one, others @ ..] => format!("component `{one}` (and {} more)", others.len()),
        };
        self.tell(format!("{who} may not read topic `{topic}`"), "reads")
    }

    fn judge_write(&mut self, topic: &str, component: &str) -> Option<String> {
        let own = self.known.as_ref()?;
        if own.writes.iter().any(|name| name == ALL || name == topic) {
            return None;
        }
        self.tell(format!("component `{component}` may not publish on topic `{topic}`"), "writes")
    }

    fn tell(&mut self, what: String, verb: &str) -> Option<String> {
        let is_new = self.told.insert(what.clone());
        is_new.then(|| {
            format!(
                "{what} of the network `{}` as user `{}`: nothing of it passes the broker; name the topic in its \
                 `access`, behind `{verb}`",
                self.url, self.user
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn granted(reads: &[&str], writes: &[&str]) -> Granted {
        let topics = |names: &[&str]| Topics::Some(names.iter().map(|name| (*name).to_owned()).collect());
        let (reads, writes) = (topics(reads), topics(writes));
        let access = Access { user: "viewer".to_owned(), reads, writes, ..Access::default() };
        Granted::of(&[Grant::new(access, false)])
    }

    #[test]
    fn what_a_program_does_without_a_right_is_told_once() {
        let mut rights = Rights::new("gate:1".to_owned(), "viewer".to_owned());
        let readers = |_: &str| vec!["Screen".to_owned(), "Log".to_owned()];
        let (positions, jobs, robot) = ("POSTOPIC".into(), "JOBS".into(), "Robot1".into());
        assert_eq!(rights.read(&positions, &readers("")), None);
        assert_eq!(rights.read(&jobs, &readers("")), None);
        assert_eq!(rights.write(&jobs, &robot), None);
        let told = rights.hear(&granted(&["POSTOPIC"], &[]), readers);
        assert_eq!(told.len(), 2, "{told:?}");
        let expected =
            "component `Screen` (and 1 more) may not read topic `JOBS` of the network `gate:1` as user `viewer`";
        assert!(told[0].starts_with(expected), "{told:?}");
        assert!(told[1].starts_with("component `Robot1` may not publish on topic `JOBS`"), "{told:?}");
        assert_eq!(rights.hear(&granted(&["POSTOPIC"], &[]), readers), Vec::<String>::new());
        assert_eq!(rights.write(&jobs, &robot), None);
        assert!(rights.write(&positions, &robot).is_some());
        // The broker begins anew, with more rights.
        assert_eq!(rights.hear(&granted(&["POSTOPIC", "JOBS"], &["*"]), readers), Vec::<String>::new());
    }

    #[test]
    fn a_user_that_is_not_named_may_do_nothing() {
        let mut rights = Rights::new("gate:1".to_owned(), "guest".to_owned());
        assert_eq!(rights.hear(&granted(&["POSTOPIC"], &[]), |_| Vec::new()), Vec::<String>::new());
        let told = rights.read(&"POSTOPIC".into(), &[]).unwrap();
        assert!(told.starts_with("the program may not read topic `POSTOPIC`"), "{told}");
    }
}
