// Orders to the fleet. A button stays pending until the fleet shows the effect: an answer alone is no effect.

import { h } from "./dom.js";

/** Time for which an effect is waited for. */
const PATIENCE_MS = 15000;

export class Orders {
  constructor(fleet, right) {
    this.fleet = fleet;
    this.mayOrder = right === "control";
    this.place = document.getElementById("messages");
  }

  /** Sends an order; gives its answer, or tells why it is refused and gives `null`. */
  async send(method, path, body = "") {
    try {
      const answer = await fetch(path, { method, body });
      const content = await answer.json().catch(() => ({}));
      if (answer.ok) return content;
      if (answer.status === 401) location.assign("/login");
      this.tell("error", content.error ?? `the server answered ${answer.status}`);
    } catch {
      this.tell("error", "The fleet cannot be reached: the order may not have arrived.");
    }
    return null;
  }

  /** An event or order as a line, as `saoms send` takes it. */
  line(text) {
    return this.send("POST", "/v1/events", text);
  }

  component(path, verb) {
    return this.send("POST", `/v1/components/${encodeURIComponent(path)}/${verb}`);
  }

  stop(...paths) {
    return this.send("POST", "/v1/estop?by=dashboard", paths.join(" "));
  }

  release(...paths) {
    return this.send("POST", "/v1/release?by=dashboard", paths.join(" "));
  }

  acknowledge(...ids) {
    return this.send("POST", "/v1/alerts/ack?by=dashboard", ids.join(" "));
  }

  /** Tells the answer to an order. */
  tell(kind, text) {
    const message = h("p", { class: `message ${kind}` }, text);
    const close = h("button", { class: "close", "aria-label": "Close", onclick: () => message.remove() }, "×");
    message.append(close);
    this.place.append(message);
    while (this.place.children.length > 4) this.place.firstChild.remove();
    if (kind !== "error") setTimeout(() => message.remove(), 5000);
  }

  /**
   * A button for an order. `order` sends it; `isDone` is true once the fleet shows its effect. Without the right to
   * control it is disabled and says why.
   */
  button(label, { order, isDone = () => true, kind = "", title = null, confirm = null }) {
    const button = h("button", { class: kind, title: this.mayOrder ? title : "Your token has the right to view alone", "data-order": label }, label);
    button.disabled = !this.mayOrder;
    button.addEventListener("click", async () => {
      if (button.getAttribute("aria-busy") === "true") return;
      if (confirm && !window.confirm(confirm)) return;
      button.setAttribute("aria-busy", "true");
      const answer = await order();
      const done = answer !== null && (await this.#until(() => isDone(answer)));
      button.removeAttribute("aria-busy");
      if (answer !== null && !done) this.tell("error", `${label}: the fleet took the order, and has not shown its effect yet.`);
    });
    return button;
  }

  /** Waits until the fleet shows something; `false` if it does not in time. */
  #until(isDone) {
    return new Promise((resolve) => {
      if (isDone()) return resolve(true);
      const end = (done) => {
        clearTimeout(timer);
        this.fleet.removeEventListener("change", look);
        resolve(done);
      };
      const look = () => isDone() && end(true);
      const timer = setTimeout(() => end(false), PATIENCE_MS);
      this.fleet.addEventListener("change", look);
    });
  }
}
