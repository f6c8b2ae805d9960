// SPDX-License-Identifier: GPL-3.0-or-later

// Bakes every image of a .blend file, a task for each: see docs/farm.md. What is up to date is left
// alone, so a job that is sent again does what is missing.

const JOB_TYPE = {
    label: "Prefilter: Bake Mipmaps",
    description: "Bakes the mipmaps of every image, fitted to the surfaces that show it.",
    settings: [
        { key: "blendfile", type: "string", required: true, visible: "web",
          description: "The .blend file" },
        { key: "textures", type: "string", subtype: "dir_path", required: true,
          eval: "bpy.path.abspath('//textures')",
          evalInfo: { showLinkButton: true, description: "The folder textures beside the file" },
          description: "The folder for the files of the images" },
        { key: "format", type: "string", required: true, default: "ktx2",
          choices: ["ktx2", "exr", "tif", "tx"], description: "The kind of the files" },
        { key: "tasks", type: "int32", required: true, default: 8,
          eval: "max(1, sum(image.source in {'FILE', 'TILED'} for image in bpy.data.images))",
          evalInfo: { showLinkButton: true, description: "As many as there are images" },
          description: "How many tasks the images are split into; with more than there are images, "
              + "some do nothing" },
    ]
};

function compileJob(job) {
    const { blendfile, textures, format, tasks } = job.settings;
    for (let number = 1; number <= tasks; number++) {
        const task = author.Task(`bake-${number}`, "blender");
        task.addCommand(author.Command("exec", {
            exe: "{blender}",
            args: ["--background", "--command", "prefilter", "bake", blendfile, "--all",
                "--output", textures, "--format", format, "--skip-up-to-date",
                "--task", `${number}/${tasks}`],
        }));
        job.addTask(task);
    }
}
