// SPDX-License-Identifier: GPL-3.0-or-later

// Makes the surface of a scan, in one task: see docs/farm.md.

const JOB_TYPE = {
    label: "Prefilter: Reconstruct Surface",
    description: "Makes a mesh of the points that a scanner has measured.",
    settings: [
        { key: "points", type: "string", subtype: "file_path", required: true,
          description: "A file of points, such as .ply, .las, .laz or .e57" },
        { key: "surface", type: "string", subtype: "file_path", required: true,
          description: "The .ply file of the surface" },
        { key: "depth", type: "int32", required: true, default: 9,
          description: "9 gives 512 cells along each axis; each step quadruples the triangles" },
        { key: "memory_limit", type: "int32", required: true, default: 0,
          description: "At most so many MiB of memory, and temporary files for the rest; 0 sets "
              + "no limit" },
    ]
};

function compileJob(job) {
    const settings = job.settings;
    const task = author.Task("reconstruct", "blender");
    task.addCommand(author.Command("exec", {
        exe: "{blender}",
        args: ["--background", "--command", "prefilter", "reconstruct", settings.points,
            settings.surface, "--depth", `${settings.depth}`,
            "--memory-limit", `${settings.memory_limit}`],
    }));
    job.addTask(task);
}
