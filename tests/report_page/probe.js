// Runs beside the report in a page that holds it in a frame, and writes what is wrong with its layout into <pre>.
addEventListener("load", () => {
  const page = document.querySelector("iframe").contentDocument;
  const root = page.documentElement;
  const faults = [];
  const name = (e) => `<${e.tagName.toLowerCase()} class="${e.getAttribute("class") || ""}"> ${e.textContent.trim().slice(0, 60)}`;
  const scrolls = (e) => ["auto", "scroll"].includes(getComputedStyle(e).overflowX);
  const inScroller = (e) => {
    for (let p = e.parentElement; p; p = p.parentElement) if (scrolls(p)) return true;
    return false;
  };
  if (root.scrollWidth > root.clientWidth) faults.push(`document ${root.scrollWidth} > ${root.clientWidth} px`);
  for (const e of page.querySelectorAll("body *")) {
    if (e.closest("svg") && e.tagName !== "svg") continue;
    const box = e.getBoundingClientRect();
    if (box.width === 0) continue;
    if (!inScroller(e) && (box.right > root.clientWidth + 0.5 || box.left < -0.5)) faults.push(`outside: ${name(e)}`);
    // What hides its overflow would cut it off without a trace.
    if (e.tagName !== "svg" && !scrolls(e) && e.scrollWidth > e.clientWidth + 1 && getComputedStyle(e).overflowX !== "visible")
      faults.push(`cut off: ${name(e)}`);
  }
  let texts = 0;
  for (const svg of page.querySelectorAll("svg")) {
    const frame = svg.getBoundingClientRect();
    const boxes = [...svg.querySelectorAll("text")].map((t) => [t, t.getBoundingClientRect()]);
    texts += boxes.length;
    boxes.forEach(([t, box], k) => {
      if (box.left < frame.left - 0.5 || box.right > frame.right + 0.5 || box.top < frame.top - 0.5 || box.bottom > frame.bottom + 0.5)
        faults.push(`outside its figure ${svg.getAttribute("aria-labelledby")}: ${t.textContent}`);
      // A line of text is higher than its letters: a fifth of its height may be shared.
      const slack = 0.2 * box.height;
      for (const [u, other] of boxes.slice(k + 1))
        if (Math.min(box.right, other.right) - Math.max(box.left, other.left) > slack &&
            Math.min(box.bottom, other.bottom) - Math.max(box.top, other.top) > slack)
          faults.push(`overlap in ${svg.getAttribute("aria-labelledby")}: "${t.textContent}" and "${u.textContent}"`);
    });
    if (getComputedStyle(svg).userSelect === "none") faults.push("text that cannot be selected");
  }
  const dark = matchMedia("(prefers-color-scheme: dark)").matches;
  document.querySelector("pre").textContent =
    JSON.stringify({ width: root.clientWidth, figures: page.querySelectorAll("svg").length, texts, dark, faults });
});
