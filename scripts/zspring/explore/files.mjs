// Parameters from and to files, tables to files. Each refusal is one line.

import { unitBases } from "./description.mjs";
import { elements, parseXml } from "./xml.mjs";

const TYPES = ["Real", "Float64", "Integer", "Enumeration", "Boolean"]; // Float64: of SSP 2

/** A parameter's value from text or number, in its type; enumerations by their items' names. Throws Error. */
export function checked(variable, given) {
  const { name, type, items, min, max } = variable;
  if (type === "Enumeration") {
    const item = items.find((one) => one.name === String(given) || String(one.value) === String(given));
    if (!item) throw new Error(`${name} = ${given}: must be one of ${items.map((one) => one.name).join(", ")}`);
    return item.name;
  }
  if (type === "Boolean") {
    if (!/^(true|false|0|1)$/.test(String(given))) throw new Error(`${name} = ${given}: must be true or false`);
    return String(given) === "true" || String(given) === "1";
  }
  const value = String(given).trim() === "" ? NaN : Number(given);
  if (!Number.isFinite(value) || (type === "Integer" && !Number.isInteger(value)))
    throw new Error(`${name} = ${given}: must be a ${type === "Integer" ? "whole" : "finite"} number`);
  const unit = variable.unit && variable.unit !== "1" ? ` ${variable.unit}` : "";
  if (value < min) throw new Error(`${name} = ${value}${unit}: must be at least ${min}`);
  if (value > max) throw new Error(`${name} = ${value}${unit}: must be at most ${max}`);
  return value;
}

export function parameterOf(description, name) {
  const variable = description.variables.get(name);
  if (!variable) throw new Error(`no parameter ${name} in ${description.model}`);
  if (variable.causality !== "parameter") throw new Error(`${name} is not a parameter but ${variable.causality}`);
  return variable;
}

/** Parameters by name of an SSV file's text, in the FMU's units. Throws Error. */
export function readSsv(text, description) {
  const root = parseXml(text);
  if (root.name !== "ParameterSet") throw new Error("is no SSV file: its root is not ParameterSet");
  const bases = unitBases(root), values = {};
  for (const element of elements(root, "Parameter")) {
    const { name } = element.attributes;
    const variable = parameterOf(description, name);
    const typed = element.children.find((child) => TYPES.includes(child.name));
    if (!typed) throw new Error(`${name}: has no value`);
    if (name in values) throw new Error(`${name}: comes twice`);
    let { value, unit } = typed.attributes;
    if (unit && unit !== variable.unit) {
      const from = bases.get(unit) ?? description.bases.get(unit), to = description.bases.get(variable.unit);
      if (!from || !to || from.exponents !== to.exponents) throw new Error(`${name}: unit ${unit}: must be ${variable.unit}`);
      value = (Number(value) * from.factor + from.offset - to.offset) / to.factor;
    }
    values[name] = checked(variable, value);
  }
  if (!Object.keys(values).length) throw new Error("has no parameter");
  return values;
}

const escaped = (text) =>
  String(text).replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);

/** The text of an SSV file with these values, in the FMU's units. */
export function writeSsv(values, description, name) {
  const used = new Set(), lines = [];
  for (const [parameter, value] of Object.entries(values)) {
    const { type, unit } = description.variables.get(parameter);
    if (type === "Real" && unit) used.add(unit);
    const own = type === "Real" && unit ? ` unit="${escaped(unit)}"` : "";
    lines.push(`    <ssv:Parameter name="${escaped(parameter)}"><ssv:${type} value="${escaped(value)}"${own}/></ssv:Parameter>`);
  }
  const units = [...used].map((unit) => {
    const { exponents, factor } = description.bases.get(unit);
    const parts = exponents ? exponents.split(",") : [];
    const base = parts.flatMap((part, i) => (i % 2 ? [] : [` ${part}="${parts[i + 1]}"`])).join("");
    return `    <ssc:Unit name="${escaped(unit)}"><ssc:BaseUnit${base}${factor === 1 ? "" : ` factor="${factor}"`}/></ssc:Unit>`;
  });
  return `<?xml version="1.0" encoding="UTF-8"?>
<ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" version="1.0" name="${escaped(name)}">
  <ssv:Parameters>
${lines.join("\n")}
  </ssv:Parameters>
  <ssv:Units>
${units.join("\n")}
  </ssv:Units>
</ssv:ParameterSet>
`;
}

/** Text of a CSV with lines of a head {key: value}, titles and rows. */
export function writeCsv(head, titles, rows) {
  const told = Object.entries(head).map(([key, value]) => `# ${key}: ${value}`);
  return [...told, titles.join(","), ...rows.map((row) => row.join(","))].join("\n") + "\n";
}
