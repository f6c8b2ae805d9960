// SPDX-License-Identifier: GPL-3.0-or-later

// Compiles a job type of Flamenco 3 as its Manager does, with a stub of the author API.
// usage: node compile_job.js SCRIPT < SETTINGS.json > TASKS.json
// Settings that are not given are as the job type says; those that it needs and lacks are refused,
// and so are keys that it does not know, as Flamenco refuses them.

"use strict";
const fs = require("fs");
const vm = require("vm");

class Command {
    constructor(name, parameters) {
        this.name = name;
        this.parameters = parameters;
    }
}

class Task {
    constructor(name, type) {
        Object.assign(this, { name, type, commands: [], dependencies: [] });
    }
    addCommand(command) {
        if (!(command instanceof Command)) throw new Error("addCommand takes a command");
        this.commands.push(command);
    }
    addDependency(task) {
        if (!(task instanceof Task)) throw new Error("addDependency takes a task");
        this.dependencies.push(task.name);
    }
}

const author = {
    Task: (name, type) => new Task(name, type),
    Command: (name, parameters) => new Command(name, parameters),
};
const context = vm.createContext({ author });
vm.runInContext(fs.readFileSync(process.argv[2], "utf8"), context);
const type = vm.runInContext("JOB_TYPE", context);
const given = JSON.parse(fs.readFileSync(0, "utf8"));
const settings = {};
for (const { key, type: kind, default: value, required } of type.settings) {
    settings[key] = key in given ? given[key] : value;
    if (required && settings[key] === undefined) throw new Error(`setting '${key}' is missing`);
    const expected = { string: "string", int32: "number", float: "number", bool: "boolean" }[kind];
    if (typeof settings[key] !== expected) throw new Error(`setting '${key}' is no ${kind}`);
}
for (const key of Object.keys(given)) {
    if (!(key in settings)) throw new Error(`there is no setting '${key}'`);
}
const tasks = [];
vm.runInContext("compileJob", context)({ settings, addTask: (task) => tasks.push(task) });
console.log(JSON.stringify({ label: type.label, tasks }));
