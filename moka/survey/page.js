"use strict";
(() => {
  const LOWEST = 1;
  const HIGHEST = 10;
  const VERSION = 1;
  const FILE_NAME = "survey-answers.json";

  const byId = (id) => document.getElementById(id);
  const data = JSON.parse(byId("data").textContent);

  // Fisher and Yates, with the browser's cryptographic random numbers.
  const shuffled = (items) => {
    const result = [...items];
    const random = crypto.getRandomValues(new Uint32Array(result.length));
    for (let last = result.length - 1; last > 0; last--) {
      const other = Math.floor((random[last] / 2 ** 32) * (last + 1));
      [result[last], result[other]] = [result[other], result[last]];
    }
    return result;
  };

  // Each person sees the sets, and the pictures in them, in an own order.
  const pages = shuffled(
    data.sets.map((pictures, set) => ({
      set,
      pictures: shuffled(pictures),
      ratings: pictures.map(() => null),
      current: 0,
    })),
  );
  let number = 0;
  let saved = true;

  const show = (id) => {
    for (const main of document.querySelectorAll("main")) {
      main.hidden = main.id !== id;
    }
    window.scrollTo(0, 0);
    byId(id).querySelector("h1").focus({ preventScroll: true });
  };

  const element = (name, properties, ...children) => {
    const made = Object.assign(document.createElement(name), properties);
    made.append(...children);
    return made;
  };

  const letter = (index) => String.fromCharCode("A".charCodeAt(0) + index);

  const scale = (page, index) => {
    const choices = [];
    for (let value = LOWEST; value <= HIGHEST; value++) {
      const input = element("input", {
        type: "radio",
        name: `picture-${index}`,
        value,
        checked: page.ratings[index] === value,
      });
      input.addEventListener("change", () => rate(index, value));
      choices.push(
        element("label", {}, input, element("span", { textContent: value })),
      );
    }
    return element("div", { className: "scale" }, ...choices);
  };

  const figure = (page, index) => {
    const { name, width, height } = page.pictures[index];
    const label = `Picture ${letter(index)}`;
    const image = element("img", { src: name, width, height, alt: label });
    image.addEventListener("error", () => {
      byId("missing").textContent = `${label} cannot be loaded.`;
    });
    const button = element(
      "button",
      { type: "button", className: "picture", title: "Enlarge or reduce" },
      image,
    );
    const set = element(
      "fieldset",
      { tabIndex: -1 },
      element("legend", { textContent: label }),
      button,
      scale(page, index),
      element(
        "div",
        { className: "ends" },
        element("span", { textContent: "highly unrealistic" }),
        element("span", { textContent: "highly realistic" }),
      ),
    );
    button.addEventListener("click", () => set.classList.toggle("large"));
    set.addEventListener("focusin", () => mark(index));
    return set;
  };

  const mark = (index) => {
    pages[number].current = index;
    [...byId("pictures").children].forEach((set, other) => {
      set.classList.toggle("current", other === index);
    });
  };

  const update = () => {
    const missing = pages[number].ratings.filter((each) => each === null);
    byId("next").disabled = missing.length > 0;
    byId("next").textContent = number + 1 < pages.length ? "Next" : "Finish";
    byId("back").disabled = number === 0;
    byId("missing").textContent = missing.length
      ? `${missing.length} still to rate`
      : "";
  };

  const rate = (index, value) => {
    pages[number].ratings[index] = value;
    saved = false;
    update();
  };

  const showPage = () => {
    const page = pages[number];
    byId("heading").textContent = `Page ${number + 1} of ${pages.length}`;
    byId("progress").max = pages.length;
    byId("progress").value = number;
    byId("pictures").replaceChildren(
      ...page.pictures.map((_, index) => figure(page, index)),
    );
    update();
    const open = page.ratings.indexOf(null);
    mark(open < 0 ? 0 : open);
    show("rating");
  };

  const turn = () => {
    if (byId("next").disabled) return;
    number += 1;
    if (number < pages.length) {
      showPage();
    } else {
      byId("answers").textContent = answers();
      show("end");
    }
  };

  const rateByKey = (value) => {
    const page = pages[number];
    const chosen = byId("pictures").querySelector(
      `input[name="picture-${page.current}"][value="${value}"]`,
    );
    chosen.checked = true;
    rate(page.current, value);
    const open = page.ratings.indexOf(null);
    // The whole of the next picture, as no rating should stand out yet.
    (open < 0 ? chosen : byId("pictures").children[open]).focus();
  };

  document.addEventListener("keydown", (event) => {
    if (byId("rating").hidden || event.repeat) return;
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (/^[0-9]$/.test(event.key)) {
      event.preventDefault();
      rateByKey(event.key === "0" ? HIGHEST : Number(event.key));
    } else if (event.key === "Enter" && event.target.tagName !== "BUTTON") {
      event.preventDefault();
      turn();
    }
  });

  const answers = () => {
    const result = {
      survey_answers: VERSION,
      survey: data.survey,
      consent: true,
      ratings: pages.flatMap(({ set, pictures, ratings }) =>
        pictures.map(({ name }, index) => ({
          set,
          picture: name,
          rating: ratings[index],
        })),
      ),
    };
    return `${JSON.stringify(result, null, 1)}\n`;
  };

  byId("agree").addEventListener("change", (event) => {
    byId("begin").disabled = !event.target.checked;
  });
  byId("begin").addEventListener("click", showPage);
  byId("next").addEventListener("click", turn);
  byId("back").addEventListener("click", () => {
    number -= 1;
    showPage();
  });
  byId("save").addEventListener("click", () => {
    const file = new Blob([answers()], { type: "application/json" });
    const url = URL.createObjectURL(file);
    element("a", { href: url, download: FILE_NAME }).click();
    setTimeout(() => URL.revokeObjectURL(url), 60000);
    saved = true;
    byId("saved").textContent = `Saved as ${FILE_NAME}.`;
  });
  window.addEventListener("beforeunload", (event) => {
    if (!saved) event.preventDefault();
  });

  // A browser keeps the state of forms when a page is loaded again.
  byId("agree").checked = false;
  show("consent");
})();
