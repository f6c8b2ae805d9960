// SPDX-License-Identifier: GPL-3.0-or-later

// Fills Cycles' texture cache with the images of a scene, then turns it on in the file: see
// docs/farm.md. The folder of the cache has to be one that all workers share.

const JOB_TYPE = {
    label: "Prefilter: Fill Texture Cache",
    description: "Bakes parameterization-aware mipmaps into the texture cache. "
        + "Needs Blender 5.2 LTS.",
    settings: [
        { key: "blendfile", type: "string", required: true, visible: "web",
          description: "The .blend file; it is saved with the texture cache turned on" },
        { key: "tasks", type: "int32", required: true, default: 8,
          eval: "max(1, sum(image.source in {'FILE', 'TILED'} for image in bpy.data.images))",
          evalInfo: { showLinkButton: true, description: "As many as there are images" },
          description: "How many tasks the image files are split into; with more than there are "
              + "files, some do nothing" },
    ]
};

function compileJob(job) {
    const { blendfile, tasks } = job.settings;
    const start = ["--background", "--command", "prefilter", "bake-cache", blendfile,
        "--skip-up-to-date"];
    const last = author.Task("turn-on", "blender");
    last.addCommand(author.Command("exec", { exe: "{blender}", args: start.concat(["--save"]) }));
    for (let number = 1; number <= tasks; number++) {
        const task = author.Task(`bake-${number}`, "blender");
        task.addCommand(author.Command("exec", {
            exe: "{blender}",
            args: start.concat(["--task", `${number}/${tasks}`]),
        }));
        job.addTask(task);
        last.addDependency(task);
    }
    job.addTask(last);
}
