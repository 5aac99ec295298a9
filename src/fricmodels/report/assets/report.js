"use strict";
(() => {
  const root = document.documentElement;
  const button = document.getElementById("scheme");
  const preference = window.matchMedia("(prefers-color-scheme: dark)");
  const drawn = new Map();

  const scheme = () => root.dataset.scheme || (preference.matches ? "dark" : "light");

  const remembered = (value) => {
    try {
      if (value) localStorage.setItem("fricmodels-scheme", value);
      return localStorage.getItem("fricmodels-scheme");
    } catch {
      return null; // a file that may not remember anything asks the system each time
    }
  };

  const label = () => {
    button.textContent = scheme() === "dark" ? "Light colours" : "Dark colours";
  };

  // Everything is unpacked without waiting, so that a page that is printed at once has its figures.
  function unpacked(name) {
    const packed = atob(document.getElementById(name).textContent);
    return new TextDecoder().decode(inflated(Uint8Array.from(packed, (letter) => letter.charCodeAt(0))));
  }

  // RFC 1951 after the ten bytes of a gzip header without a name (RFC 1952); its last four bytes are the length.
  function inflated(bytes) {
    const end = bytes.length;
    const out = new Uint8Array(new DataView(bytes.buffer).getUint32(end - 4, true));
    let at = 10, held = 0, count = 0, filled = 0;
    const bits = (need) => {
      while (count < need) { held |= bytes[at++] << count; count += 8; }
      const value = held & ((1 << need) - 1);
      held >>>= need; count -= need;
      return value;
    };
    const code = (lengths) => {
      const counts = new Uint16Array(16), starts = new Uint16Array(16), symbols = new Uint16Array(lengths.length);
      for (const length of lengths) counts[length] += 1;
      counts[0] = 0;
      for (let i = 1; i < 16; i += 1) starts[i] = starts[i - 1] + counts[i - 1];
      lengths.forEach((length, symbol) => { if (length) { symbols[starts[length]] = symbol; starts[length] += 1; } });
      return { counts, symbols };
    };
    const symbol = ({ counts, symbols }) => {
      let value = 0, first = 0, index = 0;
      for (let length = 1; ; length += 1) {
        if (!count) { held = bytes[at++]; count = 8; }
        value |= held & 1; held >>>= 1; count -= 1;
        const own = counts[length];
        if (value - first < own) return symbols[index + value - first];
        index += own; first = (first + own) << 1; value <<= 1;
      }
    };
    const size = [3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 17, 19, 23, 27, 31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258];
    const sizeBits = size.map((_, i) => (i < 8 || i === 28 ? 0 : (i - 4) >> 2));
    const far = [1, 2, 3, 4, 5, 7, 9, 13, 17, 25, 33, 49, 65, 97, 129, 193, 257, 385, 513, 769, 1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577];
    const farBits = far.map((_, i) => (i < 4 ? 0 : (i - 2) >> 1));
    for (let last = 0; !last;) {
      last = bits(1);
      const kind = bits(2);
      if (kind === 0) {
        held = 0; count = 0;
        const length = bytes[at] | (bytes[at + 1] << 8);
        out.set(bytes.subarray(at + 4, at + 4 + length), filled);
        at += 4 + length; filled += length;
        continue;
      }
      let letters = new Uint8Array(288).map((_, i) => (i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8));
      let places = new Uint8Array(30).fill(5);
      if (kind === 2) {
        const most = bits(5) + 257, distances = bits(5) + 1, own = new Uint8Array(19);
        const order = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
        for (let i = 0, n = bits(4) + 4; i < n; i += 1) own[order[i]] = bits(3);
        const lengths = new Uint8Array(most + distances), coded = code(own);
        for (let i = 0; i < lengths.length;) {
          const each = symbol(coded);
          if (each < 16) { lengths[i++] = each; continue; }
          const again = each === 16 ? lengths[i - 1] : 0;
          for (let n = each === 16 ? 3 + bits(2) : each === 17 ? 3 + bits(3) : 11 + bits(7); n; n -= 1) lengths[i++] = again;
        }
        letters = lengths.subarray(0, most); places = lengths.subarray(most);
      }
      const text = code(letters), back = code(places);
      for (;;) {
        const each = symbol(text);
        if (each < 256) { out[filled++] = each; continue; }
        if (each === 256) break;
        const length = size[each - 257] + bits(sizeBits[each - 257]);
        const place = symbol(back);
        const from = filled - far[place] - bits(farBits[place]);
        for (let i = 0; i < length; i += 1) out[filled++] = out[from + i];
      }
    }
    return out;
  }

  let looks = null;
  const library = () => {
    if (looks) return looks;
    const program = document.createElement("script");
    program.textContent = unpacked("plotly");
    document.head.append(program);
    looks = JSON.parse(unpacked("looks"));
    return looks;
  };

  // Colours are strings below any key that speaks of colour; a scheme says which stands for which.
  function recoloured(value, colours, coloured) {
    if (Array.isArray(value)) return value.map((each) => recoloured(each, colours, coloured));
    if (value !== null && typeof value === "object") {
      return Object.fromEntries(Object.entries(value).map(
        ([key, each]) => [key, recoloured(each, colours, coloured || key.includes("color"))],
      ));
    }
    return coloured && typeof value === "string" && Object.hasOwn(colours, value) ? colours[value] : value;
  }

  let paper = false;
  const LOWEST = 250, HIGHEST = 294;
  const LINE = 18;
  const STACKED = 480; // below this width two panels stand above each other
  const PAPER = 0.72; // of the height on a screen: three low figures and their captions fit a page
  const BESIDE = 0.62; // of figures beside each other: three rows fit

  // Labels of a logarithmic axis that would overlap are thinned: to 1, 2 and 5 in each decade, 1 and 3, or 1.
  function sparser(axis, room) {
    if (axis.type !== "log" || !axis.tickvals) return axis;
    const digit = (value) => Number((value / 10 ** Math.floor(Math.log10(value) + 1e-9)).toPrecision(2));
    const needed = (kept) => kept.reduce((sum, i) => sum + 8 * String(axis.ticktext[i]).length + 10, 0);
    const all = axis.tickvals.map((_, i) => i);
    for (const digits of [null, [1, 2, 5], [1, 3], [1]]) {
      const kept = digits ? all.filter((i) => digits.includes(digit(axis.tickvals[i]))) : all;
      if (kept.length < 2 || needed(kept) > room) continue;
      const only = (values) => kept.map((i) => values[i]);
      return { ...axis, tickvals: only(axis.tickvals), ticktext: only(axis.ticktext), tickangle: 0 };
    }
    return axis;
  }

  const share = (held) => (held.width === NARROW ? BESIDE : PAPER);
  const ROW = 14; // of names beneath each other, so that they do not touch
  const least = (held) => Math.max(LOWEST, ROW * (held.figure.layout.meta?.rows ?? 0) + 110);
  const onPaper = (held) => Math.max(least(held), Math.min(HIGHEST, Math.round(share(held) * held.height)));

  function drawing(held, place) {
    const { data, layout } = recoloured(
      { data: held.figure.data, layout: { ...held.figure.layout, template: held.looks.template } },
      held.looks[paper ? "light" : scheme()], false,
    );
    const margin = { ...layout.margin };
    margin.r = Math.max(22, margin.r ?? 0); // half a label beyond the last tick
    margin.t = Math.max(12, (margin.t ?? 58) - 46); // the caption has the title
    const width = paper ? held.width : place.clientWidth;
    const stacked = layout.meta?.stack && width < STACKED ? 1.7 : 1;
    if (stacked > 1) {
      Object.assign(layout.yaxis, { domain: [0.57, 1] });
      Object.assign(layout.yaxis2, { domain: [0, 0.43] });
      for (const name of ["xaxis", "xaxis2"]) Object.assign(layout[name], { domain: [0, 1] });
    }
    const lines = width < STACKED ? data.filter((each) => each.name && each.showlegend !== false).length : 1;
    const height = Math.round(stacked * held.height + LINE * Math.max(0, lines - 2)); // the legend is one below another
    if (!paper) place.style.height = `${height}px`;
    const size = paper
      ? { autosize: false, width, height: onPaper(held) }
      : { autosize: true, height };
    for (const name of Object.keys(layout)) if (/^xaxis\d*$/.test(name)) layout[name] = sparser(layout[name], width - 90);
    return [data, { ...layout, title: undefined, margin, ...size, dragmode: TOUCH ? false : "zoom" }];
  }

  const WIDE = 668, NARROW = 322; // pixels of A4 and of half of it
  const TOUCH = window.matchMedia("(pointer: coarse)").matches;
  function sized(held, place) {
    held.width = place.closest(".gallery") && !place.closest(".wide") ? NARROW : WIDE;
    place.style.height = `${onPaper(held)}px`;
  }

  const settings = { displayModeBar: false, responsive: false, showTips: false, doubleClick: "reset" };

  function draw(place) {
    if (drawn.has(place)) return;
    drawn.set(place, null);
    watcher.unobserve(place);
    try {
      const figure = JSON.parse(unpacked(place.id + "-data"));
      const held = { looks: library(), figure, width: place.clientWidth, height: place.clientHeight };
      drawn.set(place, held);
      if (paper) sized(held, place);
      Plotly.newPlot(place, ...drawing(held, place), settings);
      place.dataset.drawn = "yes";
      tools(place);
    } catch (error) {
      place.textContent = "This browser cannot draw the figure; its message stands above.";
      console.error(error);
    }
  }

  function tools(place) {
    const [save, reset] = ["save", "reset"].map((what) => document.querySelector(`[data-${what}="${place.id}"]`));
    save.hidden = false;
    save.addEventListener("click", () => Plotly.downloadImage(place, {
      format: "svg", filename: place.id, width: place.clientWidth, height: place.clientHeight,
    }));
    const whole = () => { again((each) => each === place); reset.hidden = true; };
    reset.addEventListener("click", () => { whole(); place.focus(); });
    place.on("plotly_relayout", (change) => {
      if (Object.keys(change).some((key) => key.includes("axis"))) reset.hidden = false;
    });
    place.on("plotly_doubleclick", () => { reset.hidden = true; });
    place.addEventListener("keydown", (event) => {
      const step = { "+": 0.8, "=": 0.8, "-": 1.25, ArrowLeft: -0.1, ArrowRight: 0.1 }[event.key];
      if (event.key === "Escape" || event.key === "0") whole();
      else if (step !== undefined) zoom(place, step);
      else return;
      event.preventDefault();
    });
  }

  // By the keyboard: + and - zoom along the horizontal axes, the arrows move, 0 or Escape shows all.
  function zoom(place, step) {
    const change = {};
    for (const [name, axis] of Object.entries(place._fullLayout)) {
      if (!/^xaxis\d*$/.test(name) || axis.type === "category" || axis.matches) continue;
      const [low, high] = axis.range.map(Number), middle = (low + high) / 2, half = (high - low) / 2;
      change[`${name}.range`] = Math.abs(step) > 0.5
        ? [middle - half * step, middle + half * step] : [low + 2 * half * step, high + 2 * half * step];
    }
    Plotly.relayout(place, change);
  }

  function again(changed) {
    for (const [place, held] of drawn) {
      if (!held || !changed(place, held)) continue;
      if (!paper) held.width = place.clientWidth;
      Plotly.react(place, ...drawing(held, place), settings);
    }
  }

  button.hidden = false;
  const wanted = remembered();
  if (wanted === "dark" || wanted === "light") root.dataset.scheme = wanted;
  label();
  button.addEventListener("click", () => {
    root.dataset.scheme = scheme() === "dark" ? "light" : "dark";
    remembered(root.dataset.scheme);
    label();
    again(() => true);
  });
  preference.addEventListener("change", () => { label(); again(() => true); });

  const places = [...document.querySelectorAll(".plot")];
  const watcher = new IntersectionObserver((entries) => {
    for (const entry of entries) if (entry.isIntersecting) draw(entry.target);
  }, { rootMargin: "400px" });
  places.forEach((place) => watcher.observe(place));

  // A formula wider than the page would make the browser print the whole page smaller.
  const FORMULA = 636, LETTERS = 14; // pixels of a formula's line on paper, and of the letters there
  function fitted() {
    const smaller = LETTERS / parseFloat(getComputedStyle(document.body).fontSize);
    for (const formula of document.querySelectorAll(".equations math")) {
      const width = smaller * formula.getBoundingClientRect().width;
      if (width > FORMULA) {
        const own = parseFloat(getComputedStyle(formula).fontSize) / parseFloat(getComputedStyle(formula.parentElement).fontSize);
        formula.style.fontSize = `${own * FORMULA / width}em`;
      }
    }
  }

  // On paper everything is unfolded, drawn at the width of the page (A4 or Letter), dark on white.
  let unfolded = [];
  window.addEventListener("beforeprint", () => {
    unfolded = [...document.querySelectorAll("main details:not([open])")].filter((each) => !each.closest(".tools"));
    unfolded.forEach((each) => { each.open = true; });
    paper = true;
    fitted();
    for (const [place, held] of drawn) if (held) sized(held, place);
    again(() => true);
    places.forEach(draw); // what was not drawn yet is drawn once, as it is on paper
  });
  window.addEventListener("afterprint", () => {
    paper = false;
    for (const formula of document.querySelectorAll(".equations math")) formula.style.fontSize = "";
    unfolded.forEach((each) => { each.open = false; });
    again(() => true);
  });

  // A command breaks between its words, not within "--option" or a file's name that finds room on a line.
  for (const code of document.querySelectorAll("pre code")) {
    code.replaceChildren(...code.textContent.split(/(\s+)/).map((word) => {
      if (!word.trim()) return word;
      const token = document.createElement("span");
      token.className = "token";
      token.textContent = word;
      return token;
    }));
  }

  const scrollers = () => document.querySelectorAll(".scroll").forEach((box) => {
    const hides = box.scrollWidth > box.clientWidth || box.scrollHeight > box.clientHeight;
    if (hides) box.tabIndex = 0; else box.removeAttribute("tabindex");
  });
  let waiting = 0;
  window.addEventListener("resize", () => {
    clearTimeout(waiting);
    waiting = setTimeout(() => { scrollers(); again((place, held) => place.clientWidth !== held.width); }, 150);
  });
  document.addEventListener("toggle", scrollers, true);
  scrollers();
})();
