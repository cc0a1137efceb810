"""Tables across categories, gathered from what other stages measured: the supplement's three, manifold edges, quality
of the solids, data set, time and memory.

Inputs: metrics of every model and of the real shapes, samples with their certificates, catalogues, and the
benchmark files that are there.
Outputs: one table each, as CSV and as Markdown.
"""

SOLID_SAMPLES = expand(
    each_mode(
        "<results>/samples/{{category}}/{model}/{seed}/{mode}",
        [
            model
            for model in SETTINGS.table_models
            if hasattr(SETTINGS.models[model], "grid")
        ],
    ),
    category=config["categories"],
)
ALL_METRICS = expand(
    [*MODEL_METRICS, REAL_METRICS],
    category=config["categories"],
)

PAPER_TARGETS += expand(
    "<results>/tables/{name}.csv",
    name=[
        *("fid", "variety", "reconstruction", "manifold", "quality"),
        *("dataset", "runtime"),
    ],
)


rule tabulate_supplement:
    input:
        metrics=ALL_METRICS,
        paper=workflow.source_path("../resources/paper_tables.csv"),
    output:
        table=report(
            "<results>/tables/{figure}.csv",
            caption="../report/supplement.rst",
            category="Tables",
            labels={"table": "{figure}"},
        ),
        readable="<results>/tables/{figure}.md",
    log:
        "<logs>/tabulate_supplement/{figure}.log",
    wildcard_constraints:
        figure="fid|variety|reconstruction",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=500,
    params:
        code=code_digest("tetgan.tables.supplement:tabulate_supplement"),
    shell:
        "tetgan tabulate-supplement {input.metrics:q} {output.table:q} --figure {wildcards.figure}"
        " --paper {input.paper:q} >{log:q} 2>&1"


rule tabulate_manifold:
    input:
        metrics=ALL_METRICS,
        paper=workflow.source_path("../resources/paper_tables.csv"),
    output:
        table=report(
            "<results>/tables/manifold.csv",
            caption="../report/manifold.rst",
            category="Tables",
            labels={"table": "manifold"},
        ),
        readable="<results>/tables/manifold.md",
    log:
        "<logs>/tabulate_manifold.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=500,
    params:
        code=code_digest("tetgan.tables.manifold:tabulate_manifold"),
    shell:
        "tetgan tabulate-manifold {input.metrics:q} {output.table:q} --paper {input.paper:q} >{log:q} 2>&1"


rule tabulate_quality:
    input:
        samples=SOLID_SAMPLES,
        catalogues=expand(
            "<results>/data/{category}/catalogue.csv", category=config["categories"]
        ),
        paper=workflow.source_path("../resources/paper_tables.csv"),
    output:
        table=report(
            "<results>/tables/quality.csv",
            caption="../report/quality.rst",
            category="Tables",
            labels={"table": "quality"},
        ),
        readable="<results>/tables/quality.md",
    log:
        "<logs>/tabulate_quality.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=500,
    params:
        code=code_digest("tetgan.tables.quality:tabulate_quality"),
        catalogues=lambda wildcards, input: [
            word for path in input.catalogues for word in ("--catalogue", path)
        ],
    shell:
        "tetgan tabulate-quality {input.samples:q} {output.table:q} --paper {input.paper:q} {params.catalogues:q}"
        " >{log:q} 2>&1"


rule tabulate_dataset:
    input:
        catalogues=expand(
            "<results>/data/{category}/catalogue.csv", category=config["categories"]
        ),
        paper=workflow.source_path("../resources/paper_tables.csv"),
    output:
        table=report(
            "<results>/tables/dataset.csv",
            caption="../report/dataset.rst",
            category="Tables",
            labels={"table": "dataset"},
        ),
        readable="<results>/tables/dataset.md",
    log:
        "<logs>/tabulate_dataset.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=500,
    params:
        code=code_digest("tetgan.tables.dataset:tabulate_dataset"),
    shell:
        "tetgan tabulate-dataset {input.catalogues:q} {output.table:q} --paper {input.paper:q} >{log:q} 2>&1"


# Benchmark files are read as they are found and are no inputs: one that is missing must not run its stage again.
rule tabulate_runtime:
    input:
        metrics=ALL_METRICS,
        catalogues=expand(
            "<results>/data/{category}/catalogue.csv", category=config["categories"]
        ),
        clouds=expand("<results>/clouds/{category}.npz", category=config["categories"]),
        paper=workflow.source_path("../resources/paper_tables.csv"),
    output:
        table=report(
            "<results>/tables/runtime.csv",
            caption="../report/runtime.rst",
            category="Tables",
            labels={"table": "runtime"},
        ),
        readable="<results>/tables/runtime.md",
    log:
        "<logs>/tabulate_runtime.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=1000,
    params:
        results=subpath(output.table, ancestor=2),
        shards=config["shards"],
        code=code_digest("tetgan.tables.runtime:tabulate_runtime"),
    shell:
        "tetgan tabulate-runtime {input.metrics:q} {output.table:q} --results {params.results:q}"
        " --shards {params.shards} --paper {input.paper:q} >{log:q} 2>&1"
