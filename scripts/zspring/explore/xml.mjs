// A small XML reader, for workers and node, which have none: elements with attributes, no text between them.

const ENTITIES = { lt: "<", gt: ">", amp: "&", quot: '"', apos: "'" };
const TOKEN = /<!--[^]*?-->|<\?[^]*?\?>|<!\[CDATA\[[^]*?\]\]>|<!DOCTYPE[^>]*>|<(\/?)([^\s<>/="']+)((?:\s+[^\s<>/="']+\s*=\s*(?:"[^"<]*"|'[^'<]*'))*)\s*(\/?)>|</g;
const ATTRIBUTE = /([^\s<>/="']+)\s*=\s*(?:"([^"<]*)"|'([^'<]*)')/g;

const decoded = (text) =>
  text.replace(/&(?:#x([0-9a-fA-F]+)|#(\d+)|(\w+));/g, (all, hex, decimal, name) =>
    name ? (ENTITIES[name] ?? all) : String.fromCodePoint(hex ? parseInt(hex, 16) : Number(decimal)),
  );

/** Root element of a text: {name, attributes, children}, names without prefix. Throws Error where it is no XML. */
export function parseXml(text) {
  const top = { name: "", attributes: {}, children: [] };
  const open = [top];
  for (const [token, closing, qualified, attributes, empty] of text.matchAll(TOKEN)) {
    if (qualified === undefined) {
      if (token === "<") throw new Error("is no well-formed XML");
      continue;
    }
    const name = qualified.replace(/^.*:/, "");
    if (closing) {
      if (open.pop().name !== name || !open.length) throw new Error(`is no well-formed XML: </${qualified}>`);
      continue;
    }
    const element = { name, attributes: {}, children: [] };
    for (const [, key, double, single] of attributes.matchAll(ATTRIBUTE))
      element.attributes[key] = decoded(double ?? single);
    open.at(-1).children.push(element);
    if (!empty) open.push(element);
  }
  if (open.length !== 1 || top.children.length !== 1) throw new Error("is no well-formed XML");
  return top.children[0];
}

/** All elements of this name at any depth. */
export function* elements(parent, name) {
  for (const child of parent.children) {
    if (child.name === name) yield child;
    yield* elements(child, name);
  }
}
