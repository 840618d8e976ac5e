// What an FMI 2.0 model description says of its variables.

import { elements, parseXml } from "./xml.mjs";

const TYPES = ["Real", "Integer", "Enumeration", "Boolean", "String"];
const number = (text) => (text === undefined ? undefined : Number(text));

/** The value of an attribute as the type has it: number, boolean or text; undefined where it has none. */
function valueOf(type, text) {
  if (text === undefined || type === "String") return text;
  return type === "Boolean" ? text === "true" || text === "1" : Number(text);
}

function variableOf(element, items, units) {
  const typed = element.children.find((child) => TYPES.includes(child.name));
  const { name, valueReference, causality = "local", variability = "continuous", description = "" } = element.attributes;
  const { unit = "", displayUnit = "", min, max, start, declaredType } = typed.attributes;
  return {
    name,
    reference: Number(valueReference),
    causality,
    variability,
    description,
    type: typed.name,
    unit,
    display: units.get(`${unit}|${displayUnit}`) ?? { unit, factor: 1 },
    min: number(min),
    max: number(max),
    start: valueOf(typed.name, start),
    items: items.get(declaredType) ?? [],
  };
}

/** Units by name as {exponents: text, factor, offset} to base units, of a model description or an SSV file. */
export function unitBases(root) {
  const bases = new Map();
  for (const unit of elements(root, "Unit")) {
    const { factor = 1, offset = 0, ...exponents } = unit.children.find(({ name }) => name === "BaseUnit")?.attributes ?? {};
    const set = Object.entries(exponents).filter(([, exponent]) => Number(exponent));
    bases.set(unit.attributes.name, { exponents: String(set.sort()), factor: Number(factor), offset: Number(offset) });
  }
  return bases;
}

/**
 * {model, version, guid, bases: of unitBases, variables}: a Map by name of {name, reference, causality, variability, description, type,
 * unit, display: {unit, factor}, min, max, start, items: [{name, value, description}]}.
 * A value in the display unit is factor times that in the unit. Throws Error for what is no FMI 2.0 description.
 */
export function readDescription(text) {
  const root = parseXml(text);
  if (root.name !== "fmiModelDescription" || root.attributes.fmiVersion !== "2.0")
    throw new Error("is no model description of FMI 2.0");
  const items = new Map();
  for (const type of elements(root, "SimpleType"))
    items.set(
      type.attributes.name,
      [...elements(type, "Item")].map(({ attributes }) => ({
        name: attributes.name,
        value: Number(attributes.value),
        description: attributes.description ?? "",
      })),
    );
  const units = new Map();
  const bases = unitBases(root);
  for (const unit of elements(root, "Unit"))
    for (const { attributes } of elements(unit, "DisplayUnit"))
      units.set(`${unit.attributes.name}|${attributes.name}`, { unit: attributes.name, factor: Number(attributes.factor ?? 1) });
  const variables = [...elements(root, "ScalarVariable")].map((element) => variableOf(element, items, units));
  const { modelName, version = "", guid } = root.attributes;
  return { model: modelName, version, guid, bases, variables: new Map(variables.map((variable) => [variable.name, variable])) };
}
