// Tables of the page.

/** Table rows from arrays of texts; the first one is the head, the first cell of each names the row. */
export function fill(table, rows) {
  const { caption } = table;
  table.replaceChildren(...(caption ? [caption] : []));
  rows.forEach((row, i) => {
    const line = table.insertRow();
    row.forEach((text, k) => {
      const cell = document.createElement(i && k ? "td" : "th");
      cell.textContent = text;
      cell.scope = i ? "row" : "col";
      line.append(cell);
    });
  });
}
