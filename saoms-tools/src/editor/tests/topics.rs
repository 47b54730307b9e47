//! Topics: from a name to who publishes and who reads it.

use super::marked::{defined, found, renamed};
use crate::editor::hover::hover;
use crate::editor::testing::{composite, scene};

fn fleet(other: &str) -> String {
    composite(&format!(
        r#"<component name="A"><implementation.rust class="saoms.Robot"/><property name="topicRename">COLLISIONTOPIC,quiet</property></component>
<component name="B"><implementation.rust class="saoms.Robot"/><property name="topicRename" value="COLLISIONTOPIC::{other}"/></component>
<component name="C"><implementation.rust class="saoms.Robot"/></component>"#
    ))
}

#[test]
fn a_topic_leads_to_all_who_have_it() {
    let marked = fleet("quiet").replacen(",quiet", ",qui|et", 1);
    let all = ["fleet.composite:2:107 quiet", "fleet.composite:3:115 quiet"];
    assert_eq!(defined(&marked, &[]), all, "robots publish it");
    assert_eq!(found(&marked, &[], true), all);
    // One that keeps its name is found where its component has its class.
    let plain = fleet("quiet").replacen(",quiet", ",COLL|ISION", 1).replace("::quiet", "::COLLISION");
    assert_eq!(found(&plain, &[], true).len(), 2);
    let (scene, at) = scene(&marked, &[]);
    let (said, _) = hover(&scene, at).unwrap();
    assert!(said.contains("a topic of `Collision`") && said.contains("Published by `A`, `B`"), "{said}");
    // Fleets that have nothing to do with each other may use the same names.
    let other = fleet("quiet").replace("name=\"fleet\"", "name=\"other\"");
    assert_eq!(found(&marked, &[("other.composite", &other)], true), all);
}

/// Robots publish where they are, and read where the others are.
#[test]
fn a_topic_that_is_published_and_read_is_at_one_place() {
    let robots = |name: &str| fleet(name).replace("COLLISIONTOPIC", "POSTOPIC").replace(",quiet", &format!(",{name}"));
    let marked = robots("pos").replacen(",pos", ",p|os", 1);
    assert_eq!(found(&marked, &[], true).len(), 2);
    assert_eq!(renamed(&marked, &[], "p2").unwrap(), [robots("p2")]);
}

#[test]
fn a_topic_is_renamed_where_it_gets_its_name() {
    let marked = fleet("quiet").replacen(",quiet", ",qui|et", 1);
    assert_eq!(renamed(&marked, &[], "loud").unwrap(), [fleet("loud").replace(",quiet", ",loud")]);
    assert_eq!(renamed(&marked, &[], "COLLISIONTOPIC").unwrap_err(), "the name `COLLISIONTOPIC` is already used");
    assert!(renamed(&marked, &[], "a,b").unwrap_err().contains("separate topics"));
    let own = fleet("quiet").replacen(",quiet", ",COLLISION|TOPIC", 1);
    let refused = renamed(&own, &[], "loud").unwrap_err();
    assert!(refused.contains("name in the class of"), "{refused}");
}
