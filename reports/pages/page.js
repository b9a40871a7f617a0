// Filter by outcome and by words, sort tables, move wide figures, and open the case that the address names. The page is complete without this.
"use strict";
{
  const form = document.getElementById("filter");
  const rows = [...document.querySelectorAll("tr[data-status]")];
  const sections = [...document.querySelectorAll("details.case")];
  let texts; // of every section, gathered when a word is first asked for
  const gather = () => rows.map((row, i) => {
    const section = sections[i] ?? row;
    const drawings = new Set(section.querySelectorAll("svg, .how")); // nor what is said of every figure alike
    const walker = document.createTreeWalker(section, NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT, (node) =>
      drawings.has(node) ? NodeFilter.FILTER_REJECT : NodeFilter.FILTER_ACCEPT);
    let text = "";
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
      if (node.nodeType === Node.TEXT_NODE) text += node.data;
    }
    return text.toLowerCase();
  });

  const apply = () => {
    const status = form.elements.status.value;
    const wanted = form.elements.words.value.toLowerCase().split(/\s+/).filter(Boolean);
    if (wanted.length) texts ??= gather();
    let shown = 0;
    rows.forEach((row, i) => {
      const fits = (!status || row.dataset.status === status) && wanted.every((word) => texts[i].includes(word));
      row.hidden = !fits;
      if (sections[i]) sections[i].hidden = !fits;
      shown += fits;
    });
    form.querySelector("output").value = `${shown} of ${rows.length} shown`;
  };

  const open = () => {
    let id = location.hash.slice(1);
    try { id = decodeURIComponent(id); } catch { /* not encoded: take it as it stands */ }
    const target = id && document.getElementById(id);
    const section = target && target.closest("details.case");
    if (!section) return;
    section.hidden = false;
    section.open = true;
    target.scrollIntoView();
  };

  const sortable = (table) => {
    const heads = [...table.tHead.rows[0].cells];
    const body = table.tBodies[0];
    const valueOf = (row, column) => {
      const cell = row.cells[column];
      const text = cell.dataset.value ?? cell.textContent.trim();
      return text !== "" && Number.isFinite(Number(text)) ? Number(text) : text.toLowerCase();
    };
    const compare = (a, b) => (typeof a === typeof b ? (a < b ? -1 : a > b ? 1 : 0) : typeof a === "number" ? -1 : 1);
    heads.forEach((head, column) => {
      const button = document.createElement("button");
      button.type = "button";
      button.append(...head.childNodes);
      head.append(button);
      button.addEventListener("click", () => {
        const falling = head.getAttribute("aria-sort") === "ascending";
        heads.forEach((other) => other.removeAttribute("aria-sort"));
        head.setAttribute("aria-sort", falling ? "descending" : "ascending");
        const rows = [...body.rows].map((row) => [valueOf(row, column), row]);
        rows.sort((a, b) => (falling ? compare(b[0], a[0]) : compare(a[0], b[0])));
        body.append(...rows.map((pair) => pair[1]));
      });
    });
  };
  document.querySelectorAll("table.sortable").forEach(sortable);

  // A figure that is wider than the screen is moved in its own box, by the keyboard too.
  const moved = new ResizeObserver((entries) => {
    for (const { target } of entries) {
      if (target.scrollWidth > target.clientWidth) target.tabIndex = 0;
      else target.removeAttribute("tabindex");
    }
  });
  document.querySelectorAll(".drawing").forEach((drawing) => moved.observe(drawing));

  if (form) {
    form.hidden = false;
    form.addEventListener("input", apply);
    form.addEventListener("submit", (event) => event.preventDefault());
    apply();
  }
  addEventListener("hashchange", open);
  open();
}
