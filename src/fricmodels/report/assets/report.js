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

  async function inflate(name) {
    const packed = atob(document.getElementById(name).textContent);
    const bytes = Uint8Array.from(packed, (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).text();
  }

  let loading = null;
  const library = () => {
    loading ??= (async () => {
      const program = document.createElement("script");
      program.textContent = await inflate("plotly");
      document.head.append(program);
      return JSON.parse(await inflate("looks"));
    })();
    return loading;
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

  function drawing(held, place) {
    const { data, layout } = recoloured(
      { data: held.figure.data, layout: { ...held.figure.layout, template: held.looks.template } },
      held.looks[scheme()], false,
    );
    const margin = { ...layout.margin };
    margin.r = Math.max(22, margin.r ?? 0); // half a label beyond the last tick
    margin.t = Math.max(12, (margin.t ?? 58) - 46); // the caption has the title
    return [data, { ...layout, title: undefined, margin, autosize: true, height: place.clientHeight, dragmode: TOUCH ? false : "zoom" }];
  }

  const TOUCH = window.matchMedia("(pointer: coarse)").matches;
  const settings = { displayModeBar: false, responsive: false, showTips: false, doubleClick: "reset" };

  async function draw(place) {
    if (drawn.has(place)) return;
    drawn.set(place, null);
    try {
      const looks = await library();
      const held = { looks, figure: JSON.parse(await inflate(place.id + "-data")), width: place.clientWidth };
      drawn.set(place, held);
      await Plotly.newPlot(place, ...drawing(held, place), settings);
      place.dataset.drawn = "yes";
      const save = document.querySelector(`[data-save="${place.id}"]`);
      save.hidden = false;
      save.addEventListener("click", () => Plotly.downloadImage(place, {
        format: "svg", filename: place.id, width: place.clientWidth, height: place.clientHeight,
      }));
    } catch (error) {
      place.textContent = "This browser cannot draw the figure; its message stands above.";
      console.error(error);
    }
  }

  function again(changed) {
    for (const [place, held] of drawn) {
      if (!held || !changed(place, held)) continue;
      held.width = place.clientWidth;
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
    for (const entry of entries) {
      if (entry.isIntersecting) { watcher.unobserve(entry.target); draw(entry.target); }
    }
  }, { rootMargin: "400px" });
  places.forEach((place) => watcher.observe(place));
  window.addEventListener("beforeprint", () => places.forEach(draw));

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
