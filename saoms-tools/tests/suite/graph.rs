//! Pictures of real files: each is well-formed, shows every component in the composite, and none over another.

use roxmltree::{Document, Node};
use saoms_lang::check::Occurrences;
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;
use saoms_tools::graph::{Diagram, dot, mermaid, svg};

use crate::files::{self, Sample};

/// Left, upper, right and lower end.
fn ends(node: Node<'_, '_>) -> [i32; 4] {
    let [x, y, width, height] =
        ["x", "y", "width", "height"].map(|name| node.attribute(name).unwrap().parse::<i32>().unwrap());
    [x, y, x + width, y + height]
}

#[test]
fn every_file_has_a_picture() {
    let registry = Registry::new();
    for Sample { name, text } in files::all().into_iter().step_by(4) {
        let fleet = Project::new().in_memory().text(&*name, text).load(&registry).contribution;
        let Some(composite) = fleet.asked_for().first() else { continue };
        let count = composite.components.len();
        let diagram = Diagram::of(&fleet, &registry, &Occurrences::default());
        assert!(
            mermaid(&diagram).to_string().starts_with("flowchart") && dot(&diagram).to_string().starts_with("digraph")
        );
        let text = svg(&diagram).to_string();
        let picture = Document::parse(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
        let boxes = |classes: &[&str]| -> Vec<[i32; 4]> {
            let is_meant = |node: &Node<'_, '_>| node.attribute("class").is_some_and(|class| classes.contains(&class));
            picture.descendants().filter(is_meant).map(ends).collect()
        };
        let frame = boxes(&["composite"])[0];
        let components = boxes(&["component", "component unknown", "missing"]);
        assert!(components.len() >= count, "{name}");
        for (place, one) in components.iter().enumerate() {
            assert!(frame[0] < one[0] && frame[1] < one[1] && frame[2] > one[2] && frame[3] > one[3], "{name}");
            let is_beside =
                |other: &[i32; 4]| one[2] < other[0] || other[2] < one[0] || one[3] < other[1] || other[3] < one[1];
            assert!(components[..place].iter().all(is_beside), "{name}");
        }
    }
}
