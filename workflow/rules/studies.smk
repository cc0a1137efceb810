"""Studies beside the tables: the resolution that a torus takes, and what smoothing does to surfaces.

Inputs: an exact torus; trained models, repaired meshes, hold-out clouds and the extractor. Outputs: a table and
a figure of each study, with the data of the figure.
"""

PAPER_TARGETS += ["<results>/tables/resolution.csv"]
if SETTINGS.studies.smoothing.models:
    PAPER_TARGETS += [
        "<results>/tables/smoothing.csv",
        *expand(
            "<results>/figures/{category}/smoothing.png", category=config["categories"]
        ),
    ]


rule measure_resolution:
    output:
        table=report(
            "<results>/tables/resolution.csv",
            caption="../report/resolution.rst",
            category="Tables",
            labels={"study": "resolution"},
        ),
        readable="<results>/tables/resolution.md",
        figure=report(
            "<results>/figures/resolution.png",
            caption="../report/resolution.rst",
            category="Figures",
            labels={"study": "resolution"},
        ),
        curves="<results>/figures/resolution.csv",
    log:
        "<logs>/measure_resolution.log",
    benchmark:
        "<benchmarks>/measure_resolution.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=4000,
    params:
        options=section("studies", "resolution"),
        code=code_digest("tetgan.studies.resolution.study:measure_resolution"),
    shell:
        "tetgan measure-resolution {output.table:q} {output.figure:q} --options {params.options:q}"
        " --threads {threads} >{log:q} 2>&1"


rule measure_smoothing:
    input:
        unpack(model_fields),
        weights="<results>/models/{category}/{model}/{seed}/weights.safetensors",
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
        clouds="<results>/clouds/{category}.npz",
        extractor="<results>/extractor/weights.safetensors",
    output:
        study=directory("<results>/studies/smoothing/{category}/{model}/{seed}"),
    log:
        "<logs>/measure_smoothing/{category}/{model}/{seed}.log",
    benchmark:
        "<benchmarks>/measure_smoothing/{category}/{model}/{seed}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=3000,
    params:
        model=subpath(input.weights, parent=True),
        extractor=subpath(input.extractor, parent=True),
        identity=study_identity,
        options=section("studies", "smoothing"),
        meshing=section("meshing"),
        evaluation=section("evaluation"),
        code=code_digest(
            "tetgan.studies.smoothing.study:measure_smoothing", of_model=True
        ),
    shell:
        "tetgan measure-smoothing {params.model:q} {input.index:q} {output.study:q} {input.meshes:q}"
        " --clouds {input.clouds:q} --extractor {params.extractor:q} --identity {params.identity:q}"
        " --options {params.options:q} --meshing {params.meshing:q} --evaluation {params.evaluation:q}"
        " --threads {threads} >{log:q} 2>&1"


rule tabulate_smoothing:
    input:
        studies=expand(
            "<results>/studies/smoothing/{category}/{model}/{seed}",
            category=config["categories"],
            model=config["studies"]["smoothing"]["models"],
            seed=config["seeds"],
        ),
    output:
        table=report(
            "<results>/tables/smoothing.csv",
            caption="../report/smoothing.rst",
            category="Tables",
            labels={"study": "smoothing"},
        ),
        readable="<results>/tables/smoothing.md",
    log:
        "<logs>/tabulate_smoothing.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=500,
    params:
        code=code_digest("tetgan.studies.smoothing.table:tabulate_smoothing"),
    shell:
        "tetgan tabulate-smoothing {input.studies:q} {output.table:q} >{log:q} 2>&1"


use rule draw as draw_smoothing with:
    input:
        studies=expand(
            "<results>/studies/smoothing/{{category}}/{model}/{seed}",
            model=config["studies"]["smoothing"]["models"],
            seed=config["seeds"][:1],
        ),
    output:
        **figure("smoothing"),
    log:
        "<logs>/draw_smoothing/{category}.log",
    params:
        figure="smoothing",
        names=config["studies"]["smoothing"]["models"],
        code=code_digest("draw_smoothing.py"),
