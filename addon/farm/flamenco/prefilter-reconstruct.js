// SPDX-License-Identifier: GPL-3.0-or-later

// Makes the surface of a scan in steps: each share of the points is measured, and counted into the
// cells of all; the counts are merged, the surface is made in parts, and these are joined. See
// docs/farm.md. What steps have left in the folder for that is not made again.

const JOB_TYPE = {
    label: "Prefilter: Reconstruct Surface",
    description: "Makes a mesh of the points that a scanner has measured.",
    settings: [
        { key: "points", type: "string", subtype: "dir_path", required: true,
          description: "A folder with files of points with normals, such as .ply or .laz" },
        { key: "surface", type: "string", subtype: "file_path", required: true,
          description: "The .ply file of the surface" },
        { key: "work", type: "string", subtype: "dir_path", required: true,
          description: "A folder for what steps leave each other, which all workers share" },
        { key: "depth", type: "int32", required: true, default: 9,
          description: "9 gives 512 cells along each axis; each step quadruples the triangles" },
        { key: "parts", type: "int32", required: true, default: 16,
          description: "How many parts the surface is made in" },
        { key: "tasks", type: "int32", required: true, default: 4,
          description: "How many tasks the files, and then the parts, are split into" },
        { key: "memory_limit", type: "int32", required: true, default: 0,
          description: "At most so many MiB of memory, and temporary files for the rest; 0 sets "
              + "no limit" },
    ]
};

function compileJob(job) {
    const { points, surface, work, depth, parts, tasks, memory_limit } = job.settings;
    const start = ["--background", "--command", "prefilter", "reconstruct", points,
        "--output", surface, "--depth", `${depth}`, "--memory-limit", `${memory_limit}`, "--work", work,
        "--parts", `${parts}`];
    let before = [];
    for (const step of ["measure", "count", "merge", "part", "join"]) {
        const count = step === "merge" || step === "join" ? 1 : tasks;
        const made = [];
        for (let number = 1; number <= count; number++) {
            const task = author.Task(count > 1 ? `${step}-${number}` : step, "blender");
            const args = start.concat(["--step", step, "--task", `${number}/${count}`]);
            task.addCommand(author.Command("exec", { exe: "{blender}", args: args }));
            before.forEach((other) => task.addDependency(other));
            job.addTask(task);
            made.push(task);
        }
        before = made;
    }
}
