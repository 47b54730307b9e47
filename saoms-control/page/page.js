// The parts of a page, and which of them is shown. What is shown follows the address, so that links, the buttons of the
// browser and bookmarks work.

import { component } from "./component.js";
import { h } from "./dom.js";

const main = document.getElementById("main");

/** The address of the page of a component. */
export const open = (name) => `#/component/${encodeURIComponent(name)}`;

/** A view of a crate of components, with its style sheet. */
export async function load({ name, title }) {
  document.head.append(h("link", { rel: "stylesheet", href: `/assets/views/${name}/view.css` }));
  return { name, title, module: await import(`/assets/views/${name}/view.js`) };
}

/** The parts that views bring for a fleet. */
export const ofViews = (views, page) =>
  views.filter(({ module }) => module.shows(page.fleet)).map(({ name, title, module }) => ({ path: name, title, make: () => module.view(page) }));

/** A name in an address, as somebody may have typed it. */
function decoded(name) {
  try {
    return decodeURIComponent(name);
  } catch {
    return name;
  }
}

/** The part that is shown. */
let shownPart = null;

/** What the part that is shown follows. */
export const wants = () => shownPart?.wants ?? {};

/** Shows the parts, with a link for each; a part may have a badge. */
export function present(parts, page) {
  const tabs = parts.map((part) => h("a", { href: `#/${part.path}`, "data-path": part.path }, part.title, part.badge));
  document.getElementById("tabs").append(...tabs);
  addEventListener("hashchange", () => show(parts, page));
  show(parts, page);
  setInterval(() => shownPart?.refresh(), 100);
}

function show(parts, page) {
  const [, path, name] = location.hash.match(/^#\/([^/]*)(?:\/(.*))?$/) ?? [];
  const chosen = parts.find((part) => part.path === path) ?? parts[0];
  shownPart?.close?.();
  const part = path === "component" && name ? component(decoded(name), page) : chosen.make();
  main.replaceChildren(part.element);
  main.scrollTop = 0;
  let isDue = true;
  let last = 0;
  const changed = () => (isDue = true);
  page.fleet.addEventListener("change", changed);
  shownPart = {
    wants: part.wants ?? {},
    refresh() {
      if (document.hidden || !isDue || performance.now() - last < part.every) return;
      isDue = false;
      last = performance.now();
      part.update();
    },
    close() {
      page.fleet.removeEventListener("change", changed);
      part.close?.();
    },
  };
  page.fleet.follow(shownPart.wants);
  part.update();
  const now = path === "component" ? "components" : chosen.path;
  for (const tab of document.querySelectorAll("#tabs a")) {
    if (tab.dataset.path === now) tab.setAttribute("aria-current", "page");
    else tab.removeAttribute("aria-current");
  }
}
