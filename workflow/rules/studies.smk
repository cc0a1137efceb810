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
        code=stage_digest("grids", "fields/vertices", "meshing/build", "studies"),
    shell:
        "tetgan resolution {output.table:q} {output.figure:q} --options {params.options:q}"
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
        code=model_code(
            "tetgan.studies.smoothing.study",
            "meshing",
            "nn",
            "models",
            "evaluation",
            "studies",
        ),
    shell:
        "tetgan smoothing {params.model:q} {input.index:q} {output.study:q} {input.meshes:q}"
        " --clouds {input.clouds:q} --extractor {params.extractor:q} --identity {params.identity:q}"
        " --options {params.options:q} --meshing {params.meshing:q} --evaluation {params.evaluation:q}"
        " --threads {threads} >{log:q} 2>&1"


rule make_smoothing_table:
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
        "<logs>/make_smoothing_table.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=500,
    params:
        code=stage_digest("studies"),
    shell:
        "tetgan smoothing-table {input.studies:q} {output.table:q} >{log:q} 2>&1"


rule draw_smoothing:
    input:
        studies=expand(
            "<results>/studies/smoothing/{{category}}/{model}/{seed}",
            model=config["studies"]["smoothing"]["models"],
            seed=config["seeds"][:1],
        ),
    output:
        picture=report(
            "<results>/figures/{category}/smoothing.png",
            caption="../report/smoothing.rst",
            category="Figures",
            labels={"category": "{category}", "figure": "smoothing"},
        ),
        data="<results>/figures/{category}/smoothing.csv",
    log:
        "<logs>/draw_smoothing/{category}.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=1500,
    params:
        names=config["studies"]["smoothing"]["models"],
        code=stage_digest("rendering", "studies/smoothers", "studies/sharpness"),
    script:
        "../scripts/draw_smoothing.py"
