"""What each part of TetGAN is worth: the ablations of the first category, in a table and a picture.

Inputs: metrics and samples of the models under `ablation`, the full one first. Outputs: one table, as CSV and as
Markdown; four reconstructions and four samples of each.
"""

if config["ablation"]:
    PAPER_TARGETS += ["<results>/tables/ablation.csv"]
    PAPER_TARGETS += expand(
        "<results>/figures/{category}/ablations.png", category=config["categories"][:1]
    )


rule tabulate_ablation:
    input:
        models=expand(
            "<results>/metrics/{category}/{model}/{seed}/{mode}.json",
            category=config["categories"][:1],
            model=config["ablation"],
            seed=config["seeds"],
            mode=config["modes"][0],
        ),
        real=expand(REAL_METRICS, category=config["categories"][:1]),
        paper=workflow.source_path("../resources/paper_tables.csv"),
    output:
        table=report(
            "<results>/tables/ablation.csv",
            caption="../report/ablation.rst",
            category="Tables",
            labels={"category": config["categories"][0], "table": "ablation"},
        ),
        readable="<results>/tables/ablation.md",
    log:
        "<logs>/tabulate_ablation.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=500,
    params:
        category=config["categories"][0],
        changes=ablation_changes,
        code=code_digest("tetgan.tables.ablation:tabulate_ablation"),
    shell:
        "tetgan tabulate-ablation {input.models:q} {input.real:q} {output.table:q} --category {params.category}"
        " --paper {input.paper:q} --changes {params.changes:q} >{log:q} 2>&1"


use rule draw as draw_ablations with:
    input:
        samples=expand(
            "<results>/samples/{{category}}/{model}/{seed}/{mode}",
            model=config["ablation"],
            seed=config["seeds"][:1],
            mode=config["modes"][0],
        ),
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
    output:
        **figure("ablations"),
    log:
        "<logs>/draw_ablations/{category}.log",
    params:
        figure="ablations",
        names=config["ablation"],
        code=code_digest("draw_ablations.py"),
