//! Each example of `docs/composites.md` runs: it is written into the fleet at the top of the page, as the page says.

use std::fs;
use std::path::PathBuf;

use crate::support::{code, empty_folder, project, root, saoms_in, stdout, text};

const END: &str = "</composite>\n";

/// The blocks of a language, in order.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let fence = format!("```{language}\n");
    page.split(&fence).skip(1).map(|rest| rest.split("```").next().unwrap().to_owned()).collect()
}

/// The components of a composite or of a part of one, and what is before the first of them. They contain no others.
fn components(text: &str) -> (&str, Vec<&str>) {
    let mut parts = Vec::new();
    let start = text.find("<component ").unwrap_or(text.len());
    let mut rest = &text[start..];
    while let Some(end) = rest.find("</component>") {
        let (one, behind) = rest.split_at(end + "</component>".len());
        parts.push(one.trim());
        rest = behind;
    }
    (&text[..start], parts)
}

/// The name of a component; of replicas, that of the first.
fn name(component: &str) -> String {
    component.split('"').nth(1).unwrap().replace("${index}", "1")
}

/// The fleet of the page with a part: components take the places of those of their names, the rest comes before.
fn with_part(fleet: &str, part: &str) -> String {
    let (head, own) = components(fleet);
    let (before, given) = components(part);
    let after = part.rsplit_once("</component>").map_or("", |(_, after)| after);
    let kept = own.into_iter().filter(|one| !given.iter().any(|other| name(other) == name(one)));
    let components: Vec<&str> = given.iter().copied().chain(kept).collect();
    format!("{head}{before}{}{after}{END}", components.join("\n"))
}

/// A folder with the files that the page names.
fn folder(page: &str, fleet: &str) -> PathBuf {
    let folder = empty_folder("composites-page");
    fs::write(folder.join("hall.composite"), fleet).unwrap();
    let map = blocks(page, "text").into_iter().find(|text| text.starts_with("...")).unwrap();
    fs::write(folder.join("map.txt"), map).unwrap();
    fs::write(folder.join("robots.csv"), &blocks(page, "csv")[0]).unwrap();
    for file in ["area.composite", "team.composite"] {
        fs::copy(root().join("composites/teams").join(file), folder.join(file)).unwrap();
    }
    folder
}

#[test]
fn every_example_of_the_page_about_composites_runs() {
    let page = project("docs/composites.md");
    let all = blocks(&page, "xml");
    let fleet = &all[0];
    let folder = folder(&page, fleet);
    let (mut whole, mut parts) = (0, 0);
    for block in &all {
        if block.starts_with("<contribution") {
            continue;
        }
        // One that others use is beside them.
        if block.contains("name=\"cell\"") {
            fs::write(folder.join("cell.composite"), block).unwrap();
            whole += 1;
            continue;
        }
        let text_of_run = if block.starts_with("<composite") {
            whole += 1;
            block.replace("name=\"hall\"", "name=\"fleet\"")
        } else if block.contains("promote=") {
            // What leads out has something around it.
            let inner = format!(
                "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"inner\" targetNamespace=\"urn:hall\">\n{block}{END}"
            );
            fs::write(folder.join("inner.composite"), inner).unwrap();
            let outer = "<component name=\"Robot1\"><implementation.composite name=\"t:inner\"/><reference name=\"world\" target=\"World\"/></component>";
            parts += 1;
            with_part(fleet, outer).replace("name=\"hall\"", "name=\"fleet\" xmlns:t=\"urn:hall\"")
        } else {
            parts += 1;
            with_part(fleet, block).replace("name=\"hall\"", "name=\"fleet\" xmlns:t=\"urn:teams\"")
        };
        let file = folder.join("fleet.composite");
        fs::write(&file, &text_of_run).unwrap();
        let output = saoms_in(&folder, &["check", "fleet.composite"]);
        assert_eq!(code(&output), 0, "{text_of_run}\n{}", text(&output));
        // The includes of the page have no robot of their own.
        if text_of_run.contains("saoms.Robot") || text_of_run.contains("h:hall") {
            assert!(text(&output).contains("0 warnings"), "{text_of_run}\n{}", text(&output));
            let run = saoms_in(&folder, &["run", "fleet.composite", "--virtual", "--for", "1min"]);
            assert!(stdout(&run).contains("done after"), "{text_of_run}\n{}", text(&run));
        }
    }
    assert_eq!(whole, 4, "complete composites");
    assert!(parts >= 13, "{parts} parts");
}
