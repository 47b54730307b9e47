//! Pictures as SVG.

use std::collections::HashMap;
use std::fmt::Write as _;

use super::diagram::{Diagram, DiagramComponent, DiagramSetting, DiagramTopic, LinkKind, Port, State};
use super::layout::measure::{CHEVRON, CHIP_HEIGHT, CHIP_SIZE, Chip, LABEL, NAME_SIZE, SMALL_SIZE};
use super::layout::{LEGEND, Layout, Line, LineKind, Mark, Placed, Point, Rail, Rect, border, heading, layout};
use super::picture::{Picture, Sink};
use super::text::{left_out, width, xml};

/// The colours of topics, dark enough for lines on white (Okabe, Ito: Color universal design, 2008; yellow left out).
const TOPICS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#555555"];

const STYLE: &str = "\
text{font-family:Helvetica,Arial,'Liberation Sans',sans-serif;fill:#1c2733}\
.composite{fill:#f6f9fc;stroke:#46617e;stroke-width:1.5}\
.component{fill:#d8e6f5;stroke:#46617e}\
.unknown{stroke:#c0392b;stroke-dasharray:5 3}\
.missing{fill:#fff;stroke:#c0392b;stroke-dasharray:5 3}\
.service{fill:#86c067;stroke:#3d7a22}\
.reference{fill:#b59ad6;stroke:#62399a}\
.property{fill:#ffe680;stroke:#a88c00}\
.wire{fill:none;stroke:#33475b;stroke-width:1.5;stroke-linecap:square}\
.promotion{fill:none;stroke:#33475b;stroke-width:1.2;stroke-dasharray:4 3}\
.topics{fill:none;stroke:#9aa7b4}\
.rail{fill:none;stroke-width:3;stroke-linecap:round}\
.name{font-weight:bold}.small{fill:#46566a}\
";

/// Draws a diagram as a picture in the notation of SCA Assembly, in pixels.
///
/// Services are green chevrons on the left, references purple chevrons on the right, properties yellow boxes on top.
/// Topics are rails below the components; a triangle into a rail publishes, one out of it reads. Details (interfaces,
/// values, types of messages) are shown as tooltips.
pub fn svg(diagram: &Diagram) -> Picture<'_> {
    Picture { diagram, draw }
}

fn draw(diagram: &Diagram, text: &mut Sink<'_>) {
    let layout = layout(diagram, true);
    let mut out = Out { text, topics: HashMap::new() };
    let Layout { width, height, .. } = layout;
    let _ = writeln!(
        out.text,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} \
         {height}\">"
    );
    let _ = writeln!(out.text, "<title>{}</title>\n<style>{STYLE}</style>", xml(&diagram.name));
    let _ = writeln!(out.text, "<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>");
    out.draw(diagram, &layout);
    out.legend(diagram, &layout);
    out.text.push_str("</svg>\n");
}

/// The distance from the side of a component to the lines that join its inner parts to it.
const TIE: i32 = 4;
/// The names of one rail that its tooltip has.
const MOST_NAMES: usize = 40;

struct Out<'o, 's> {
    text: &'o mut Sink<'s>,
    /// The topics that have a colour: one is of the same colour in all composites.
    topics: HashMap<String, &'static str>,
}

impl Out<'_, '_> {
    fn draw(&mut self, diagram: &Diagram, layout: &Layout) {
        self.composite(diagram, layout);
        layout.lines.iter().for_each(|line| self.line(line));
        let colors: Vec<_> = diagram.topics.iter().map(|topic| self.color(&topic.name)).collect();
        for ((rail, topic), color) in layout.rails.iter().zip(&diagram.topics).zip(&colors) {
            self.rail(rail, topic, color);
        }
        self.marks(&layout.marks, &colors);
        for (placed, component) in layout.components.iter().zip(&diagram.components) {
            self.component(placed, component);
        }
        for (at, port) in layout.services.iter().zip(&diagram.services) {
            self.port("service", *at, port, Point { x: at.x - LABEL, y: at.y }, "end");
        }
        for (at, port) in layout.references.iter().zip(&diagram.references) {
            self.port("reference", *at, port, Point { x: at.x + LABEL, y: at.y }, "start");
        }
    }

    fn color(&mut self, topic: &str) -> &'static str {
        let next = TOPICS[self.topics.len() % TOPICS.len()];
        self.topics.entry(topic.to_owned()).or_insert(next)
    }

    fn line(&mut self, line: &Line) {
        let class = match line.kind {
            LineKind::Wire => "wire",
            LineKind::Promotion => "promotion",
            LineKind::Topics => "topics",
        };
        let path = line.parts.iter().map(|(from, to)| {
            if from.y == to.y {
                format!("M{},{}H{}", from.x, from.y, to.x)
            } else {
                format!("M{},{}V{}", from.x, from.y, to.y)
            }
        });
        let _ = writeln!(self.text, "<path class=\"{class}\" d=\"{}\"/>", path.collect::<String>());
        for dot in &line.dots {
            let _ = writeln!(self.text, "<circle cx=\"{}\" cy=\"{}\" r=\"2.5\" fill=\"#33475b\"/>", dot.x, dot.y);
        }
    }

    fn composite(&mut self, diagram: &Diagram, layout: &Layout) {
        self.rect("composite", layout.frame, 14);
        let Rect { x, y, .. } = layout.frame;
        let name = Point { x: x + 16, y: y + 23 + layout.name };
        let _ = write!(self.text, "<g>");
        let about = [Some(diagram.name.as_str()), diagram.namespace.as_deref()];
        self.title(&about.into_iter().flatten().collect::<Vec<_>>());
        self.label("name", name, &heading(&diagram.name), NAME_SIZE + 2, "start");
        self.text.push_str("</g>\n");
        self.chips(&layout.chips, &diagram.properties, Point { x: 0, y: 0 });
    }

    fn component(&mut self, placed: &Placed, component: &DiagramComponent) {
        let Placed { rect, plan } = placed;
        let class = match component.state {
            State::Known => "component",
            State::NotFound => "component unknown",
            State::Missing => "missing",
        };
        self.text.push_str("<g>");
        let label = component.label();
        let mut about = vec![label.as_str()];
        if !component.class.is_empty() {
            about.push(&component.class);
        }
        match component.state {
            State::Known => {}
            State::NotFound => about.push(match component.class.strip_prefix("composite ") {
                Some(_) => "no such composite is found",
                None => "no such class is registered",
            }),
            State::Missing => about.push("the composite has no such component"),
        }
        self.title(&about);
        let body = Rect { y: rect.y + plan.body, height: rect.height - plan.body, ..*rect };
        self.rect(class, body, 8);
        let middle = |y| Point { x: rect.x + rect.width / 2, y: rect.y + y };
        self.label("name", middle(plan.name), &plan.name_text, NAME_SIZE, "middle");
        if !plan.class_text.is_empty() {
            self.label("small", middle(plan.class), &plan.class_text, SMALL_SIZE, "middle");
        }
        self.chips(&plan.chips, &component.properties, Point { x: rect.x, y: rect.y });
        // Behind the chevrons that it joins.
        if let Some((picture, at)) = &plan.inside {
            self.ties(placed, component, picture, Point { x: rect.x + at.x, y: rect.y + at.y });
        }
        for (place, port) in component.services.iter().enumerate() {
            let at = Point { x: rect.x, y: rect.y + plan.port(place) };
            let label = Point { x: at.x + LABEL, y: at.y };
            self.port_as("service", at, port, &plan.services[place], label, "start");
        }
        for (place, port) in component.references.iter().enumerate() {
            let at = Point { x: rect.x + rect.width, y: rect.y + plan.port(place) };
            let label = Point { x: at.x - LABEL, y: at.y };
            self.port_as("reference", at, port, &plan.references[place], label, "end");
        }
        if let (Some((picture, at)), Some(inside)) = (&plan.inside, &component.inside) {
            let Point { x, y } = Point { x: rect.x + at.x, y: rect.y + at.y };
            let _ = writeln!(self.text, "<g transform=\"translate({x},{y})\">");
            self.draw(inside, picture);
            self.text.push_str("</g>");
        }
        self.text.push_str("</g>\n");
    }

    /// Joins what a composite promotes to the parts of its component of the same names: on each side by one line, as
    /// the names say which belong together.
    fn ties(&mut self, placed: &Placed, component: &DiagramComponent, picture: &Layout, at: Point) {
        let Placed { rect, plan } = placed;
        let (left, right) = (rect.x + TIE, rect.x + rect.width - TIE);
        let sides = [
            (left, 1, &component.services, &picture.services),
            (right, -1, &component.references, &picture.references),
        ];
        for (x, inwards, outer, places) in sides {
            let mut path = String::new();
            let (mut top, mut bottom) = (i32::MAX, i32::MIN);
            for (outer, port) in outer.iter().enumerate() {
                let Some(place) = port.inside else { continue };
                let end = Point { x: at.x + places[place].x, y: at.y + places[place].y };
                // Up to its name, which stands outside of the frame.
                let room = LABEL + width(&border(&port.name), SMALL_SIZE, false) + 2;
                let _ = write!(path, "M{x},{}H{}", end.y, end.x - inwards * room);
                (top, bottom) = (top.min(rect.y + plan.port(outer)), bottom.max(end.y));
            }
            if !path.is_empty() {
                let _ = writeln!(self.text, "<path class=\"promotion\" d=\"M{x},{top}V{bottom}{path}\"/>");
            }
        }
    }

    fn port(&mut self, class: &str, at: Point, port: &Port, label: Point, anchor: &str) {
        self.port_as(class, at, port, &border(&port.name), label, anchor);
    }

    /// A port with its name as it is shown; the whole name is in the tooltip.
    fn port_as(&mut self, class: &str, at: Point, port: &Port, shown: &str, label: Point, anchor: &str) {
        self.text.push_str("<g>");
        let about: Vec<&str> = [Some(port.name.as_str()), port.interface.as_deref()].into_iter().flatten().collect();
        self.title(&about);
        self.chevron(class, at);
        if !shown.is_empty() {
            self.label("", Point { y: label.y + 3, ..label }, shown, SMALL_SIZE, anchor);
        }
        self.text.push_str("</g>");
    }

    fn chevron(&mut self, class: &str, Point { x, y }: Point) {
        let (far, near) = (CHEVRON, CHEVRON - 5);
        let _ = write!(
            self.text,
            "<path class=\"{class}\" d=\"M{},{}H{}L{},{y}L{},{}H{}L{},{y}Z\"/>",
            x - far,
            y - 6,
            x + near,
            x + far,
            x + near,
            y + 6,
            x - far,
            x - near
        );
    }

    fn chips(&mut self, chips: &[Chip], settings: &[DiagramSetting], origin: Point) {
        for (chip, setting) in chips.iter().zip(settings) {
            let (x, y) = (origin.x + chip.x, origin.y + chip.y);
            self.text.push_str("<g>");
            let text = format!("{} = {}", setting.name, setting.value.as_deref().unwrap_or("..."));
            // A line of a value is not taken for the name of another property.
            let text = text.replace('\n', "\n    ");
            self.title(&text.split('\n').collect::<Vec<_>>());
            self.rect("property", Rect { x, y, width: chip.width, height: CHIP_HEIGHT }, 0);
            self.label("", Point { x: x + 4, y: y + 10 }, &chip.text, CHIP_SIZE, "start");
            self.text.push_str("</g>");
        }
    }

    fn rail(&mut self, rail: &Rail, topic: &DiagramTopic, color: &str) {
        let Rect { x, y, width, height } = rail.label;
        let middle = y + height / 2;
        self.text.push_str("<g>");
        let shown = topic.names.iter().take(MOST_NAMES).map(String::as_str).collect::<Vec<_>>().join(", ");
        let more = if topic.names.len() > MOST_NAMES { ", ..." } else { "" };
        self.title(&[&format!("{shown}{more}"), &format!("{} topic of {}", topic.kind.name(), topic.message)]);
        let _ =
            write!(self.text, "<path class=\"rail\" stroke=\"{color}\" d=\"M{},{middle}H{}\"/>", rail.from, rail.to);
        let _ = write!(
            self.text,
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" rx=\"8\" fill=\"#fff\" \
             stroke=\"{color}\" stroke-width=\"1.5\"/>"
        );
        self.label("", Point { x: x + 10, y: middle + 4 }, &rail.text, SMALL_SIZE, "start");
        self.text.push_str("</g>\n");
    }

    /// The marks of topics: all of one topic in one path, as a fleet has very many.
    fn marks(&mut self, marks: &[Mark], colors: &[&str]) {
        let mut paths = vec![(String::new(), String::new()); colors.len()];
        for mark in marks {
            let (published, read) = &mut paths[mark.topic];
            let Point { x, y } = mark.at;
            let mut base = y - 2;
            if mark.publishes {
                triangle(published, x, base - 7, base);
                base -= 8;
            }
            if mark.reads {
                triangle(read, x, base, base - 7);
            }
        }
        for ((published, read), color) in paths.iter().zip(colors) {
            self.triangles(published, color, true);
            self.triangles(read, color, false);
        }
    }

    fn triangles(&mut self, path: &str, color: &str, is_full: bool) {
        let fill = if is_full { color } else { "#fff" };
        if !path.is_empty() {
            let _ = writeln!(self.text, "<path fill=\"{fill}\" stroke=\"{color}\" d=\"{path}\"/>");
        }
    }

    fn legend(&mut self, diagram: &Diagram, layout: &Layout) {
        let y = layout.height - LEGEND / 2;
        let mut x = layout.frame.x + 8;
        let mut entry = |out: &mut Self, text: &str, draw: &dyn Fn(&mut Self, i32)| {
            draw(out, x);
            out.label("small", Point { x: x + 24, y: y + 4 }, text, SMALL_SIZE, "start");
            x += 24 + width(text, SMALL_SIZE, false) + 16;
        };
        let has_ports = |ports: fn(&DiagramComponent) -> bool| diagram.any(&|one| one.components.iter().any(ports));
        let has = |kind: LinkKind| diagram.any(&|one| one.links.iter().any(|link| link.kind == kind));
        let has_properties =
            |one: &Diagram| !one.properties.is_empty() || one.components.iter().any(|one| !one.properties.is_empty());
        if has_ports(|one| !one.services.is_empty()) {
            entry(self, "service", &|out, x| out.chevron("service", Point { x: x + 9, y }));
        }
        if has_ports(|one| !one.references.is_empty()) {
            entry(self, "reference", &|out, x| out.chevron("reference", Point { x: x + 9, y }));
        }
        if diagram.any(&has_properties) {
            entry(self, "property", &|out, x| {
                out.rect("property", Rect { x, y: y - 6, width: 18, height: 12 }, 0);
            });
        }
        if has(LinkKind::Wire) {
            entry(self, "wire", &|out, x| _ = write!(out.text, "<path class=\"wire\" d=\"M{x},{y}h18\"/>"));
        }
        if has(LinkKind::Promotion) {
            entry(self, "promotion", &|out, x| {
                let _ = write!(out.text, "<path class=\"promotion\" d=\"M{x},{y}h18\"/>");
            });
        }
        if diagram.any(&|one| one.topics.iter().any(|topic| !topic.publishers.is_empty())) {
            entry(self, "publishes a topic", &|out, x| {
                let mut path = String::new();
                triangle(&mut path, x + 9, y - 4, y + 4);
                out.triangles(&path, TOPICS[0], true);
            });
        }
        if diagram.any(&|one| one.topics.iter().any(|topic| !topic.subscribers.is_empty())) {
            entry(self, "reads a topic", &|out, x| {
                let mut path = String::new();
                triangle(&mut path, x + 9, y + 4, y - 4);
                out.triangles(&path, TOPICS[0], false);
            });
        }
        if let Some(note) = left_out(diagram) {
            entry(self, &note, &|_, _| ());
        }
        self.text.push_str("\n");
    }

    fn rect(&mut self, class: &str, Rect { x, y, width, height }: Rect, round: i32) {
        let _ = write!(
            self.text,
            "<rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" rx=\"{round}\"/>"
        );
    }

    fn title(&mut self, lines: &[&str]) {
        let lines: Vec<String> = lines.iter().map(|line| xml(line)).collect();
        let _ = write!(self.text, "<title>{}</title>", lines.join("\n"));
    }

    fn label(&mut self, class: &str, at: Point, text: &str, size: i32, anchor: &str) {
        let Point { x, y } = at;
        let _ = write!(
            self.text,
            "<text class=\"{class}\" x=\"{x}\" y=\"{y}\" font-size=\"{size}\" text-anchor=\"{anchor}\">{}</text>",
            xml(text)
        );
    }
}

/// Adds a triangle with its tip at `tip`.
fn triangle(path: &mut String, x: i32, base: i32, tip: i32) {
    let _ = write!(path, "M{},{base}h6L{x},{tip}z", x - 3);
}
