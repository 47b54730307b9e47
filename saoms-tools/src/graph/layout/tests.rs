//! Pictures that can be read, of whatever there is to draw.

use proptest::prelude::*;
use saoms_api::host::TopicKind;

use super::measure::{CHEVRON, CHIP_HEIGHT, LABEL, NAME_SIZE, SMALL_SIZE};
use super::{Layout, LineKind, Point, Rect, layout};
use crate::graph::diagram::{
    Diagram, DiagramComponent, DiagramEnd, DiagramLink, DiagramSetting, DiagramTopic, LinkKind, Port, State,
};
use crate::graph::text::width;

/// The parts of a picture: for each component the numbers of its properties, services and references.
type Parts = Vec<(usize, usize, usize)>;

fn names(kind: &str, count: usize) -> impl Iterator<Item = String> {
    (0..count).map(move |place| format!("{kind}{}", "x".repeat(place * 5)))
}

fn ports(kind: &str, count: usize) -> Vec<Port> {
    names(kind, count).map(|name| Port::named(&name)).collect()
}

/// `wires` are pairs of numbers, each of a reference or service, counted through all components.
fn diagram(parts: &Parts, wires: &[(usize, usize)], topics: &[(usize, usize)], promoted: usize) -> Diagram {
    let component = |(place, (properties, services, references)): (usize, &(usize, usize, usize))| DiagramComponent {
        replicas: None,
        name: format!("Component{place}"),
        class: "a.package.of.classes.with.a.long.name.Class".to_owned(),
        state: State::Known,
        properties: names("p", *properties).map(|name| DiagramSetting { name, value: None }).collect(),
        services: ports("s", *services),
        references: ports("r", *references),
        inside: None,
    };
    let ends = |port: fn(&(usize, usize, usize)) -> usize| -> Vec<DiagramEnd> {
        let of = |(component, parts)| (0..port(parts)).map(move |port| DiagramEnd::Component { component, port });
        parts.iter().enumerate().flat_map(of).collect()
    };
    let (services, references) = (ends(|parts| parts.1), ends(|parts| parts.2));
    let mut links = Vec::new();
    if !services.is_empty() && !references.is_empty() {
        for (from, to) in wires {
            let (from, to) = (references[from % references.len()], services[to % services.len()]);
            let link = DiagramLink { kind: LinkKind::Wire, from, to };
            if !links.contains(&link) {
                links.push(link);
            }
        }
    }
    let promoted = promoted.min(services.len()).min(references.len());
    for place in 0..promoted {
        let kind = LinkKind::Promotion;
        links.push(DiagramLink { kind, from: DiagramEnd::Composite(place), to: services[place] });
        links.push(DiagramLink { kind, from: references[place], to: DiagramEnd::Composite(place) });
    }
    let some = |from: usize, step: usize| {
        let count = parts.len();
        (0..count).filter(move |place| (place + from).is_multiple_of(step.max(1))).collect()
    };
    let topic = |(place, (from, step)): (usize, &(usize, usize))| DiagramTopic {
        names: Vec::new(),
        name: format!("TOPIC{place}"),
        kind: TopicKind::Event,
        message: "M".to_owned(),
        publishers: some(*from, *step),
        subscribers: some(*step, *from + 1),
    };
    Diagram {
        name: "composite".to_owned(),
        namespace: None,
        properties: Vec::new(),
        services: ports("in", promoted),
        references: ports("out", promoted),
        components: parts.iter().enumerate().map(component).collect(),
        links,
        topics: topics.iter().enumerate().map(topic).collect(),
        left_out: 0,
    }
}

fn overlap(one: Rect, other: Rect) -> bool {
    one.x < other.x + other.width
        && other.x < one.x + one.width
        && one.y < other.y + other.height
        && other.y < one.y + one.height
}

fn contains(outer: Rect, inner: Rect) -> bool {
    outer.x <= inner.x
        && outer.y <= inner.y
        && inner.x + inner.width <= outer.x + outer.width
        && inner.y + inner.height <= outer.y + outer.height
}

/// The rectangle of a horizontal or vertical part, without its ends.
fn inside((from, to): (Point, Point)) -> Rect {
    let (x, y) = (from.x.min(to.x), from.y.min(to.y));
    let (width, height) = ((from.x - to.x).abs(), (from.y - to.y).abs());
    if height == 0 {
        Rect { x: x + 1, y, width: (width - 2).max(0), height: 1 }
    } else {
        Rect { x, y: y + 1, width: 1, height: (height - 2).max(0) }
    }
}

fn is_readable(layout: &Layout, diagram: &Diagram) {
    let picture = Rect { x: 0, y: 0, width: layout.width, height: layout.height };
    assert!(contains(picture, layout.frame));
    assert_eq!(layout.components.len(), diagram.components.len());
    let rects: Vec<Rect> = layout.components.iter().map(|placed| placed.rect).collect();
    for (place, rect) in rects.iter().enumerate() {
        let wide = Rect { x: rect.x - CHEVRON, width: rect.width + 2 * CHEVRON, ..*rect };
        assert!(contains(layout.frame, wide), "component {place} is in the composite");
        for other in &rects[..place] {
            assert!(!overlap(wide, *other), "component {place} is beside the others");
        }
        labels_fit(layout, place);
    }
    lines_are_apart(layout);
    let labels: Vec<Rect> = layout.rails.iter().map(|rail| rail.label).collect();
    for (place, label) in labels.iter().enumerate() {
        assert!(contains(layout.frame, *label));
        assert!(rects.iter().chain(&labels[..place]).all(|other| !overlap(*label, *other)));
        let mut lines = layout.lines.iter().flat_map(|line| &line.parts);
        assert!(lines.all(|part| !overlap(inside(*part), *label)), "no line runs over the label of a topic");
    }
}

fn labels_fit(layout: &Layout, place: usize) {
    let plan = &layout.components[place].plan;
    let texts = width(&plan.name_text, NAME_SIZE, true).max(width(&plan.class_text, SMALL_SIZE, false));
    assert!(texts <= plan.width);
    let label =
        |labels: &[String], row: usize| labels.get(row).map_or(0, |label| LABEL + width(label, SMALL_SIZE, false));
    for row in 0..plan.services.len().max(plan.references.len()) {
        assert!(label(&plan.services, row) + label(&plan.references, row) < plan.width);
        assert!(plan.port(row) < plan.height);
    }
    let chips = plan.chips.iter().map(|chip| Rect { x: chip.x, y: chip.y, width: chip.width, height: CHIP_HEIGHT });
    let chips: Vec<Rect> = chips.collect();
    let whole = Rect { x: 0, y: 0, width: plan.width, height: plan.name - NAME_SIZE + 3 };
    for (at, chip) in chips.iter().enumerate() {
        assert!(contains(whole, *chip), "the properties stand above the name");
        assert!(chips[..at].iter().all(|other| !overlap(*chip, *other)));
    }
}

/// No line runs over a component, and lines that run together for a while start or end at one place.
fn lines_are_apart(layout: &Layout) {
    let all: Vec<(usize, LineKind, (Point, Point))> = layout
        .lines
        .iter()
        .enumerate()
        .flat_map(|(line, one)| one.parts.iter().map(move |part| (line, one.kind, *part)))
        .collect();
    for (at, (line, _, part)) in all.iter().enumerate() {
        for placed in &layout.components {
            let body = Rect {
                x: placed.rect.x + 1,
                width: placed.rect.width - 2,
                y: placed.rect.y + placed.plan.body,
                height: placed.rect.height - placed.plan.body,
            };
            assert!(!overlap(inside(*part), body), "line {line} runs over a component");
        }
        for (other, _, beside) in &all[..at] {
            let same = [part.0, part.1].iter().any(|end| [beside.0, beside.1].contains(end));
            let is_vertical = part.0.x == part.1.x;
            let both = is_vertical == (beside.0.x == beside.1.x);
            if line != other && both && !same {
                assert!(!overlap(inside(*part), inside(*beside)), "{part:?} of {line} and {beside:?} of {other}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whatever_is_drawn_can_be_read(
        parts in proptest::collection::vec((0..6_usize, 0..4_usize, 0..4_usize), 0..14),
        wires in proptest::collection::vec((0..40_usize, 0..40_usize), 0..24),
        topics in proptest::collection::vec((0..4_usize, 0..4_usize), 0..4),
        promoted in 0..3_usize,
    ) {
        let diagram = diagram(&parts, &wires, &topics, promoted);
        is_readable(&layout(&diagram, true), &diagram);
    }
}

#[test]
fn three_components_and_sixty_fill_a_screen() {
    for count in [3, 60] {
        let wires: Vec<(usize, usize)> = (0..count).map(|from| (from, 0)).collect();
        let diagram = diagram(&vec![(4, 1, 1); count], &wires[1..], &[(0, 1), (0, 2)], 1);
        let layout = layout(&diagram, true);
        is_readable(&layout, &diagram);
        let shape = f64::from(layout.width) / f64::from(layout.height);
        assert!((0.8..3.5).contains(&shape), "{count}: {} x {}", layout.width, layout.height);
    }
}

#[test]
fn a_very_large_composite_has_a_picture() {
    let count = 2000;
    let wires: Vec<(usize, usize)> = (0..count).map(|from| (from, from / 3)).collect();
    let layout = layout(&diagram(&vec![(2, 1, 1); count], &wires, &[(0, 1)], 0), true);
    assert_eq!(layout.components.len(), count);
}

/// Wires over many columns would come to the product of both.
#[test]
fn very_long_wires_go_above_the_columns() {
    let count = 400;
    let next = (0..count - 1).map(|place| (2 * place, place + 1));
    // One from each component to its counterpart at the other end.
    let across = (0..count / 2).map(|place| (2 * place + 1, count - 1 - place));
    let wires: Vec<(usize, usize)> = next.chain(across).collect();
    let diagram = diagram(&vec![(0, 1, 2); count], &wires, &[], 0);
    let layout = layout(&diagram, true);
    assert_eq!(layout.components.len(), count);
    let parts: usize = layout.lines.iter().map(|line| line.parts.len()).sum();
    assert!(parts <= 12 * wires.len(), "{parts} parts of {} wires", wires.len());
}

#[test]
fn what_is_inside_a_component_stands_inside_its_box() {
    let inner = diagram(&vec![(2, 1, 1); 4], &[(0, 1), (1, 2)], &[(0, 1)], 1);
    let mut outer = diagram(&vec![(1, 1, 1); 3], &[(0, 1)], &[(0, 1)], 1);
    outer.components[1].inside = Some(Box::new(inner.clone()));
    let layout = layout(&outer, true);
    is_readable(&layout, &outer);
    let plan = &layout.components[1].plan;
    let (picture, at) = plan.inside.as_ref().unwrap();
    is_readable(picture, &inner);
    let body = Rect { x: 0, y: plan.port(0) + 6, width: plan.width, height: plan.height - plan.port(0) - 6 };
    assert!(contains(body, Rect { x: at.x, y: at.y, width: picture.width, height: picture.height }));
}
