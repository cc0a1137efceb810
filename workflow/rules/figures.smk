"""Pictures beside the tables.

Inputs: folders of samples and the repaired meshes. Output: one sheet a category.
"""

PAPER_TARGETS += expand(
    "<results>/figures/{category}/samples.png", category=config["categories"]
)


rule draw_samples:
    input:
        samples=expand(
            "<results>/samples/{{category}}/{model}/{seed}/{mode}",
            model=SHOWN_MODELS,
            seed=config["seeds"][:1],
            mode="paper",
        ),
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
    output:
        picture=report(
            "<results>/figures/{category}/samples.png",
            caption="../report/samples.rst",
            category="Figures",
            labels={"category": "{category}", "figure": "samples"},
        ),
    log:
        "<logs>/draw_samples/{category}.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=1500,
    params:
        names=SHOWN_MODELS,
        code=stage_digest("rendering"),
    script:
        "../scripts/draw_samples.py"
