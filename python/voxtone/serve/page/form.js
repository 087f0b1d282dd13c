// SPDX-License-Identifier: GPL-3.0-or-later
// The form of a job's options, made of the program's own table.
import {make} from "./tools.js";

let number = 0;

function isOn(option) {
  return option.default === "true";
}

/// Where the option takes a file, those that were handed in are offered; printers and resin sets by their names.
function suggestions(option, lists, files) {
  if (option.name === "printer") return lists.printers.map((printer) => printer.id);
  if (option.name === "resins") return lists.resins.map((set) => set.name);
  return option.value.includes("FILE") ? files : [];
}

export class Form {
  /// `changed` is called after each change of a value.
  constructor(table, lists, files, values, changed) {
    this.values = {...values};
    this.changed = changed;
    const basics = table.basic.map((name) => table.groups.flatMap((group) => group.options).find((option) => option.name === name)).filter(Boolean);
    const more = make("details", {}, make("summary", {}, "More options"));
    for (const group of table.groups) {
      const rest = group.options.filter((option) => !option.basic);
      if (!rest.length) continue;
      const rare = rest.every((option) => option.rare);
      const inner = make("details", {open: !rare}, make("summary", {}, group.name), this.fields(rest, lists, files));
      more.append(inner);
    }
    this.element = make("div", {}, this.fields(basics, lists, files), more);
  }

  fields(options, lists, files) {
    return make("div", {className: "fields"}, ...options.map((option) => this.field(option, lists, files)));
  }

  field(option, lists, files) {
    const id = `option-${++number}`;
    const given = this.values[option.name];
    const offered = suggestions(option, lists, files);
    let input;
    if (option.flag) {
      input = make("input", {type: "checkbox", id, checked: given === undefined ? isOn(option) : given});
    } else if ((option.choices.length && !option.separator && !option.many && option.value !== "LIST") || (offered.length && !option.many && option.value.includes("|") )) {
      const choices = option.choices.length ? option.choices : offered;
      input = make("select", {id}, ...choices.map((choice) => make("option", {value: choice}, choice)));
      if (!option.default) input.prepend(make("option", {value: ""}, "as it comes"));
      input.value = given ?? option.default;
    } else {
      input = make("input", {type: "text", id, placeholder: option.default || option.value, value: Array.isArray(given) ? given.join("; ") : given ?? "",
                             autocomplete: "off", spellcheck: false});
      if (offered.length) {
        input.setAttribute("list", `${id}-list`);
      }
    }
    input.setAttribute("aria-describedby", `${id}-help`);
    const back = make("button", {type: "button", className: "back", title: `back to ${option.default || "nothing"}`, hidden: true}, "reset");
    const field = make("div", {className: option.flag ? "field flag" : "field"},
      back, make("label", {htmlFor: id}, ...(option.flag ? [input, option.name] : [option.name])), option.flag ? null : input,
      offered.length && input.tagName === "INPUT" ? make("datalist", {id: `${id}-list`}, ...offered.map((one) => make("option", {value: one}))) : null,
      make("p", {className: "help", id: `${id}-help`}, option.help));
    const show = () => {
      const is = this.values[option.name] !== undefined;
      field.classList.toggle("changed", is);
      back.hidden = !is;
    };
    const take = () => {
      const value = this.valueOf(option, input);
      if (value === undefined) delete this.values[option.name];
      else this.values[option.name] = value;
      show();
      this.changed();
    };
    input.addEventListener(option.flag || input.tagName === "SELECT" ? "change" : "input", take);
    back.addEventListener("click", () => {
      if (option.flag) input.checked = isOn(option);
      else input.value = input.tagName === "SELECT" ? option.default : "";
      take();
      input.focus();
    });
    show();
    return field;
  }

  /// Nothing where it is the default.
  valueOf(option, input) {
    if (option.flag) return input.checked === isOn(option) ? undefined : input.checked;
    const text = input.value.trim();
    if (text === "" || text === option.default) return undefined;
    return option.many && text.includes("; ") ? text.split(/;\s+/) : text;
  }
}
