// What is known of one place: colours, differences, what lies under it, how thick the body is there.

const PROBE_DEPTHS_MM = [0, 0.1, 0.2, 0.4, 0.7, 1];

class Probe {
  constructor(surface, resins, viewingDistance) {
    this.surface = surface;
    /// Once there are such.
    this.voxels = null;
    this.hit = null;
    this.resins = resins;
    this.viewingDistance = viewingDistance;
    this.list = document.getElementById("probe-list");
    this.mixture = document.getElementById("probe-mixture");
  }

  /// `hit` of pick(); null: nothing is there.
  show(hit) {
    this.hit = hit;
    document.getElementById("probe-values").hidden = !hit;
    document.getElementById("probe-hint").hidden = Boolean(hit);
    if (!hit) return;
    const { asked, expected, parts } = this.surface;
    this.swatch("probe-target", asked, hit.place);
    this.swatch("probe-print", expected, hit.place);
    const rows = [];
    if (parts.length) this.showPart(hit, rows);
    else this.showPlace(hit, rows);
    this.list.replaceChildren(...rows.flatMap(([term, text]) => [element("dt", term), element("dd", text)]));
  }

  showPlace(hit, rows) {
    const { seen, single } = this.surface;
    if (seen) rows.push([`CIEDE2000 at ${this.viewingDistance} mm`, differenceText(seen[hit.place])]);
    if (single) rows.push(["CIEDE2000, this spot", differenceText(single[hit.place])]);
    this.under(hit, rows);
    rows.push(["x, y, z, mm", hit.at.map((x) => x.toFixed(2)).join("  ")]);
    if (hit.column !== undefined) rows.push(["column, row", `${hit.column}, ${hit.row}`]);
  }

  /// What is known of the part that the place belongs to, and other looks' colours of the place itself.
  showPart(hit, rows) {
    const { surface } = this;
    const part = surface.partAt(hit.place);
    rows.push(["square", part ? part.name : "none: nothing is predicted here"]);
    if (part) rows.push(...part.figures.map(({ what, text }) => [what, text]));
    for (const { name, rgb } of surface.looks)
      if (rgb && ![surface.asked, surface.expected, "difference"].includes(name))
        rows.push([`${name}, this spot`, hexOf(rgb.subarray(3 * hit.place, 3 * hit.place + 3))]);
    if (surface.toScale) rows.push(["x, y, mm", hit.at.slice(0, 2).map((x) => x.toFixed(1)).join("  ")]);
    this.mixture.replaceChildren();
    if (!part) return;
    this.mixture.append(element("h4", "Resins"));
    this.addShares("", new Map(part.shares.map(({ resin, share }) => [resin + 1, share])));
  }

  /// With what has been unpacked since.
  again() {
    this.show(this.hit);
  }

  swatch(id, name, place) {
    const look = this.surface.look(name);
    const swatch = document.getElementById(id);
    swatch.parentElement.hidden = !look || !look.rgb;
    if (!look || !look.rgb) return;
    const rgb = look.rgb.subarray(3 * place, 3 * place + 3);
    swatch.style.background = cssOf(rgb);
    const caption = swatch.parentElement.querySelector("figcaption");
    caption.firstChild.textContent = `${name} `;
    caption.querySelector("span").textContent = hexOf(rgb);
  }

  under(hit, rows) {
    this.mixture.replaceChildren();
    if (!this.voxels || !this.voxels.complete) return;
    const radius = Math.max(0.15, this.surface.placeMm / 2);
    const { shares, thickness } = this.voxels.inward(hit.at, hit.normal, PROBE_DEPTHS_MM, radius);
    const largest = Math.max(...this.voxels.pitch.map((pitch, a) => pitch * this.voxels.step[a]));
    if (thickness > 0) rows.push(["thickness here", `${thickness.toFixed(thickness < 3 ? 2 : 1)} mm ± ${largest.toFixed(2)}`]);
    this.mixture.append(element("h4", "Resins by depth"));
    shares.forEach((share, d) => this.addShares(`${PROBE_DEPTHS_MM[d]} to ${PROBE_DEPTHS_MM[d + 1]} mm`, share));
  }

  /// A bar of resins, by their materials.
  addShares(where, share) {
    const row = element("div");
    row.className = "depth";
    row.append(element("span", where));
    const bar = element("i");
    const all = [...share.values()].reduce((sum, n) => sum + n, 0);
    const words = [];
    this.resins.forEach((resin, r) => {
      const part = all ? (share.get(r + 1) || 0) / all : 0;
      if (!part) return;
      const piece = element("b");
      piece.style.width = `${100 * part}%`;
      piece.style.background = cssOf(resin.rgb);
      bar.append(piece);
      words.push(`${resin.role || resin.name} ${part < 0.005 ? "below 1" : Math.round(100 * part)} %`);
    });
    row.append(bar, element("small", words.join(", ") || "nothing"));
    this.mixture.append(row);
  }
}

const element = (name, text = "") => {
  const made = document.createElement(name);
  made.textContent = text;
  return made;
};
