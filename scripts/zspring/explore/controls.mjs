// The form of the pantograph's parameters, made from the model description.

import { checked } from "./files.mjs";

export const SET_BY_VIEWS = /^(drive$|bench\.)/;
const SLIDERS = ["zspring.Mf", "zspring.k", "zspring.l0", "zspring.L1", "zspring.L2", "zspring.d", "m1", "k1", "c3", "k2", "static_force"];
const RANGE = 4; // a slider goes to so many times the start value
const NOTCHES = 400;

const html = (tag, attributes = {}, ...children) => {
  const element = Object.assign(document.createElement(tag), attributes);
  element.append(...children);
  return element;
};

export class Controls {
  /** description: of the pantograph; changed(live) is told of each change, live while a slider moves. */
  constructor(description, defaults, changed, refused) {
    this.description = description;
    this.defaults = defaults; // instead of the description's starts
    this.changed = changed;
    this.refused = refused;
    this.values = {}; // that differ from the starts
    this.fields = new Map();
    this.rows = new Map();
    for (const variable of description.variables.values()) {
      if (variable.causality !== "parameter" || SET_BY_VIEWS.test(variable.name)) continue;
      const at = variable.type === "Enumeration" && variable.name !== "solver.tangent" ? "choices"
        : SLIDERS.includes(variable.name) ? "sliders" : "others";
      const row = this.field(variable);
      document.getElementById(at).append(row);
      this.rows.set(variable.name, row);
    }
  }

  start({ name, start, type, items }) {
    const value = this.defaults[name] ?? start;
    return type === "Enumeration" ? checked(this.description.variables.get(name), value) : value;
  }

  get(name) {
    return this.values[name] ?? this.start(this.description.variables.get(name));
  }

  field(variable) {
    const { name, description, type, items, display } = variable;
    const set = (text, live) => {
      try {
        const shown = type === "Real" && String(text).trim() !== "" ? Number((Number(text) / display.factor).toPrecision(15)) : text;
        this.set({ [name]: checked(variable, shown) }, live);
        input.setCustomValidity("");
      } catch (error) {
        input.setCustomValidity(error.message);
        this.refused(error.message);
      }
    };
    const id = `value-${name}`;
    if (type === "Enumeration" || type === "Boolean") {
      const choices = type === "Boolean" ? [{ name: "true" }, { name: "false" }] : items;
      const options = choices.map((item) => html("option", { value: item.name, title: item.description ?? "" }, item.name));
      var input = html("select", { id, title: description }, ...options);
      input.onchange = () => set(input.value, false);
      this.fields.set(name, () => (input.value = String(this.get(name))));
      this.fields.get(name)();
      return html("label", { className: "choice" }, name, input);
    }
    var input = html("input", { id, type: "number", step: "any", title: description });
    input.onchange = () => set(input.value, false);
    const parts = [html("label", { htmlFor: id, title: description }, name), input, html("span", {}, display.unit === "1" ? "" : display.unit)];
    const start = this.start(variable);
    let slider = null;
    if (SLIDERS.includes(name) && start > 0) {
      slider = html("input", { type: "range", min: -NOTCHES, max: NOTCHES, id: `slider-${name}`, title: description });
      slider.setAttribute("aria-label", name);
      const value = () => Number((start * RANGE ** (slider.value / NOTCHES)).toPrecision(4));
      slider.oninput = () => set(value() * display.factor, true);
      slider.onchange = () => set(value() * display.factor, false);
      parts.push(slider);
    }
    this.fields.set(name, () => {
      const value = this.get(name);
      input.value = String(Number((value * display.factor).toPrecision(12)));
      input.setCustomValidity("");
      if (slider) {
        if (document.activeElement !== slider) slider.value = value > 0 ? (NOTCHES * Math.log(value / start)) / Math.log(RANGE) : -NOTCHES;
        slider.setAttribute("aria-valuetext", `${input.value} ${display.unit}`);
      }
    });
    this.fields.get(name)();
    return html("div", { className: "parameter" }, ...parts);
  }

  /** Values that count, added to those that were set. */
  set(values, live = false) {
    for (const [name, value] of Object.entries(values)) {
      if (SET_BY_VIEWS.test(name)) continue;
      if (value === this.start(this.description.variables.get(name))) delete this.values[name];
      else this.values[name] = value;
      this.fields.get(name)?.();
    }
    for (const [name, row] of this.rows) row.hidden = !this.counts(name);
    this.changed(live);
  }

  /** Those of these values that differ from the starts. */
  apart(values) {
    return Object.fromEntries(Object.entries(values).filter(([name, value]) => value !== this.start(this.description.variables.get(name))));
  }

  replace(values) {
    this.values = {};
    for (const show of this.fields.values()) show();
    this.set(values);
  }

  /** Whether a parameter has an effect with the suspension as it is. */
  counts(name) {
    const suspension = this.get("suspension");
    if (name === "k1") return suspension === "Linear";
    return /^zspring\./.test(name) ? suspension !== "Linear" : name !== "friction" || suspension === "ZSpring";
  }

  /** All that an FMU is to be told. */
  get parameters() {
    return { ...this.defaults, ...this.values };
  }

  /** Names of Z-spring parameters whose value nobody measured. */
  get synthetic() {
    if (this.get("suspension") === "Linear") return [];
    return [...this.description.variables.values()]
      .filter(({ name, description }) => description.includes("(synthetic)") && !(name in this.values))
      .map(({ name }) => name);
  }
}
