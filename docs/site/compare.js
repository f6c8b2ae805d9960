// SPDX-License-Identifier: GPL-3.0-or-later

// Under pictures that show the same thing side by side: two of their panels on top of each other,
// and a slider between them. Each panel is the left and the top of a square of the picture, in its
// pixels, and what it shows.
const COMPARED = {
  "texture_cache.png": {
    size: [440, 370],
    panels: [[484, 14, "Blender's cache"], [946, 14, "PAM in the cache"]],
  },
  "level4.png": {
    size: [332, 274],
    panels: [[360, 10, "Box, level 4"], [1055, 10, "PAM bilinear, level 4"]],
  },
  "resize.png": {
    size: [384, 384],
    panels: [[416, 16, "Box"], [416, 440, "Least squares, ringing"]],
  },
};

function layer(image, [left, top], [width, height]) {
  const part = document.createElement("div");
  part.className = "compare-layer";
  const sheet = image.cloneNode();
  sheet.alt = "";
  sheet.removeAttribute("id");
  sheet.style.width = `${(100 * image.naturalWidth) / width}%`;
  sheet.style.left = `${(-100 * left) / width}%`;
  sheet.style.top = `${(-100 * top) / height}%`;
  part.append(sheet);
  return part;
}

function compare(image, { size, panels }) {
  const figure = document.createElement("div");
  figure.className = "compare";
  figure.style.aspectRatio = `${size[0]} / ${size[1]}`;
  figure.style.maxWidth = `${1.4 * size[0]}px`;
  const [before, after] = panels.map((panel) => layer(image, panel, size));
  const slider = document.createElement("input");
  slider.type = "range";
  slider.value = 50;
  slider.setAttribute("aria-label", `Left: ${panels[0][2]}. Right: ${panels[1][2]}`);
  const names = panels.map((panel) => {
    const name = document.createElement("span");
    name.textContent = panel[2];
    return name;
  });
  const show = () => figure.style.setProperty("--at", `${slider.value}%`);
  slider.addEventListener("input", show);
  show();
  figure.append(before, after, ...names, slider);
  (image.closest("p") ?? image).after(figure);
}

for (const image of document.querySelectorAll("img")) {
  const found = COMPARED[image.src.split("/").pop()];
  if (!found) continue;
  if (image.complete) compare(image, found);
  else image.addEventListener("load", () => compare(image, found), { once: true });
}
