"""Metrics of every model and of the real shapes, and the table beside the paper's.

Inputs: folders of samples, repaired meshes, hold-out clouds, the extractor. Outputs: one JSON of metrics a
model, seed and mode; one table a category, as CSV and as Markdown.
"""

# Behind the rows of a category's table, which stays a wildcard.
MODEL_METRICS = each_mode(
    "<results>/metrics/{{category}}/{model}/{seed}/{mode}.json", SETTINGS.table_models
)
REAL_METRICS = "<results>/metrics/{category}/real.json"

PAPER_TARGETS += expand(
    "<results>/tables/{category}.csv", category=config["categories"]
)


rule evaluate_model:
    input:
        samples="<results>/samples/{category}/{model}/{seed}/{mode}",
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
        catalogue="<results>/data/{category}/catalogue.csv",
        clouds="<results>/clouds/{category}.npz",
        extractor="<results>/extractor/weights.safetensors",
    output:
        metrics="<results>/metrics/{category}/{model}/{seed}/{mode}.json",
    log:
        "<logs>/evaluate_model/{category}/{model}/{seed}/{mode}.log",
    benchmark:
        "<benchmarks>/evaluate_model/{category}/{model}/{seed}/{mode}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=2500,
    params:
        identity=identity,
        extractor=subpath(input.extractor, parent=True),
        options=section("evaluation"),
        code=code_digest("tetgan.evaluation.evaluate:evaluate_model"),
    shell:
        "tetgan evaluate-model {input.samples:q} {input.meshes:q} {output.metrics:q} --clouds {input.clouds:q}"
        " --catalogue {input.catalogue:q} --extractor {params.extractor:q} --identity {params.identity:q} --options {params.options:q}"
        " --threads {threads} >{log:q} 2>&1"


rule evaluate_real:
    input:
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
        catalogue="<results>/data/{category}/catalogue.csv",
        clouds="<results>/clouds/{category}.npz",
        extractor="<results>/extractor/weights.safetensors",
    output:
        metrics="<results>/metrics/{category}/real.json",
    log:
        "<logs>/evaluate_real/{category}.log",
    benchmark:
        "<benchmarks>/evaluate_real/{category}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=2500,
    params:
        extractor=subpath(input.extractor, parent=True),
        options=section("evaluation"),
        code=code_digest("tetgan.evaluation.evaluate:evaluate_real"),
    shell:
        "tetgan evaluate-real {input.meshes:q} {output.metrics:q} --category {wildcards.category}"
        " --catalogue {input.catalogue:q} --clouds {input.clouds:q} --extractor {params.extractor:q}"
        " --options {params.options:q} --threads {threads} >{log:q} 2>&1"


rule tabulate_category:
    input:
        models=MODEL_METRICS,
        real=REAL_METRICS,
        paper=workflow.source_path("../resources/paper_tables.csv"),
    output:
        table=report(
            "<results>/tables/{category}.csv",
            caption="../report/table.rst",
            category="Tables",
            labels={"category": "{category}"},
        ),
        readable="<results>/tables/{category}.md",
    log:
        "<logs>/tabulate_category/{category}.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=500,
    params:
        code=code_digest("tetgan.tables.category:tabulate_category"),
    shell:
        "tetgan tabulate-category {input.models:q} {input.real:q} {output.table:q} --category {wildcards.category}"
        " --paper {input.paper:q} >{log:q} 2>&1"
