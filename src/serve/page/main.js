// The page: what is chosen, and what is shown of it.

const by_id = (id) => document.getElementById(id);

class Page {
  constructor() {
    this.places = [];
    this.described = [];
    this.shown = {};
    this.asking = 0;
    this.chart = new ProfileChart(by_id("chart"), (station) => { this.pointed = station; this.map.want(); });
    this.map = new TileMap(by_id("map"), {
      picked: (at) => this.pick(at),
      complained: (reason) => this.complain(reason),
      draw_over: () => this.draw_over(),
      moved: () => this.show_frame(),
    });
    by_id("nearer").addEventListener("click", () => this.map.zoom_at(1));
    by_id("farther").addEventListener("click", () => this.map.zoom_at(-1));
    by_id("whole").addEventListener("click", () => this.map.whole());
    by_id("clear").addEventListener("click", () => this.clear());
    by_id("tools").addEventListener("change", () => this.choose_tool());
    by_id("dataset").addEventListener("change", () => this.choose_dataset());
    by_id("settings").addEventListener("change", () => this.ask());
    by_id("settings").addEventListener("submit", (event) => event.preventDefault());
    by_id("place").addEventListener("submit", (event) => { event.preventDefault(); this.pick_written(); });
    by_id("map").addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.clear();
      if (event.key === "Backspace") this.take_back();
    });
    this.choose_tool();
    this.start();
  }

  get tool() { return TOOLS[this.tool_name]; }
  get isIdle() { return this.asking === 0 && this.map.isIdle && Boolean(this.dataset); }

  async start() {
    await this.working(async () => {
      const { results } = await ask("datasets", {});
      this.datasets = results;
      by_id("dataset").replaceChildren(...results.map(({ name }) => new Option(name, name)));
      by_id("datasets").hidden = results.length < 2;
      this.choose_dataset();
    });
  }

  choose_dataset() {
    this.dataset = this.datasets[by_id("dataset").selectedIndex];
    document.title = `${this.dataset.name} – sandtable`;
    this.clear();
    this.map.show(this.dataset);
    if (!this.dataset.bounds) {
      this.complain("This dataset has no map, because it states no coordinate system with a place on Earth. All requests answer in its own coordinates by crs=native.");
    }
  }

  choose_tool() {
    this.tool_name = document.querySelector("#tools input:checked").value;
    by_id("hint").textContent = this.tool.hint;
    document.querySelectorAll("#settings label").forEach((label) => {
      label.hidden = !label.dataset.tools.split(" ").includes(this.tool_name);
    });
    this.clear();
  }

  clear() {
    this.stop?.abort();
    [this.places, this.described] = [[], []];
    this.complain("");
    this.show({});
  }

  /** Takes a place; a tool that has all its places begins anew. */
  pick(at) {
    if (!this.dataset?.bounds) return;
    const isFull = this.places.length >= this.tool.places && !this.tool.isLonger;
    if (isFull) [this.places, this.described] = [[], []];
    this.places.push(at);
    this.map.reveal(at);
    this.ask();
  }

  take_back() {
    this.places.pop();
    this.described.pop();
    this.ask();
  }

  async pick_written() {
    const text = by_id("position").value.trim();
    if (!text || !this.dataset) return;
    await this.working(async () => {
      const at = await place_of(this.dataset, text);
      by_id("position").value = "";
      this.pick(at);
    });
  }

  settings() {
    const number = (id, least) => {
      const value = by_id(id).valueAsNumber;
      if (!(value >= least)) throw new Error(`Write a number from ${least} on for “${by_id(id).closest("label").firstChild.textContent.trim()}”.`);
      return value;
    };
    return { observer: number("observer", 0), target: number("target", 0), range: number("range", 0) };
  }

  /** Asks about the chosen places, and forgets an earlier question. */
  async ask() {
    this.stop?.abort();
    const stop = (this.stop = new AbortController());
    const { dataset, places, tool } = this;
    this.complain("");
    this.show({});
    if (places.length === 0) return;
    await this.working(async () => {
      const fresh = places.slice(this.described.length).map((at) => described(dataset, at, stop.signal));
      const described_places = this.described.concat(await Promise.all(fresh));
      if (stop !== this.stop) return;
      this.described = described_places;
      this.show_points();
      if (places.length < tool.places) return;
      const settings = this.settings();
      const shown = await tool.ask({ dataset, places: [...places], described_places, settings, signal: stop.signal });
      if (stop === this.stop) this.show(shown);
    });
  }

  async working(act) {
    this.asking += 1;
    try {
      await act();
    } catch (error) {
      if (error.name !== "AbortError") this.complain(error.message);
    }
    this.asking -= 1;
  }

  complain(reason) { by_id("error").textContent = reason; }

  show(shown) {
    this.shown = shown;
    by_id("verdict").textContent = shown.verdict ?? "";
    const rows = (shown.facts ?? []).flatMap(([name, value]) => [element("dt", name), element("dd", value)]);
    by_id("facts").replaceChildren(...rows);
    if (shown.chart) this.chart.show(shown.chart.stations, shown.chart.length_m, shown.chart.marks);
    else this.chart.hide();
    this.pointed = null;
    this.show_points();
    this.map.want();
  }

  letter(index) { return this.tool.letters?.[index] ?? String(index + 1); }

  show_points() {
    const rows = this.described.map((it, index) => {
      const list = element("dl");
      const fact = (name, value) => { if (value) list.append(element("dt", name), element("dd", value)); };
      if (this.tool_name !== "height") {
        fact("Height", it.elevation === null ? ABSENCES[it.status] ?? it.status : `${it.elevation.toFixed(2)} m`);
      }
      fact("Degrees", degrees(this.places[index]));
      fact("UTM", it.utm);
      fact("MGRS", it.mgrs);
      const item = element("li");
      if (this.tool_name !== "height") item.append(element("b", { E: "Eye", T: "Target" }[this.letter(index)] ?? `Place ${index + 1}`));
      item.append(list);
      return item;
    });
    by_id("points").replaceChildren(...rows);
    by_id("clear").hidden = this.places.length === 0;
  }

  draw_over() {
    const { shown, map, places } = this;
    if (shown.grid?.places) map.draw_grid(shown.grid.picture, shown.grid.places, GRID_STEPS);
    const lines = shown.lines ?? (this.tool.places > 1 ? [{ places, color: LINE }] : []);
    lines.forEach((line) => map.draw_line(line.places, line.color));
    places.forEach((at, index) => map.draw_point(at, this.tool_name === "height" ? "" : this.letter(index), "#1d2a33"));
    (shown.points ?? []).forEach(({ at, letter, color }) => map.draw_point(at, letter, color));
    if (this.pointed) map.draw_point(this.pointed.location, "", LINE);
  }

  show_frame() {
    const { map } = this;
    by_id("cursor").textContent = map.pointed ? degrees(map.place_at(map.pointed)) : "";
    const { lat } = map.place_at({ x: map.width / 2, y: map.height / 2 });
    const meters_per_pixel = (2 * Math.PI * 6378137 * Math.cos((lat * Math.PI) / 180)) / map.size;
    const power = 10 ** Math.floor(Math.log10(120 * meters_per_pixel));
    const length = [5, 2, 1].map((factor) => factor * power).find((length) => length <= 120 * meters_per_pixel);
    const bar = by_id("scale").firstElementChild;
    bar.textContent = length >= 1000 ? `${length / 1000} km` : `${length} m`;
    bar.style.width = `${length / meters_per_pixel}px`;
  }
}

function element(name, text = "") {
  const made = document.createElement(name);
  made.textContent = text;
  return made;
}

window.sandtable = new Page();
