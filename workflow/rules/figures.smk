"""Figures of a category, each a picture with the data behind it beside it.

Inputs: folders of samples, trained models, the fields and repaired meshes. Outputs: under <results>/figures;
the interpolated and summed meshes under <results>/latent, the nearest training shapes under <results>/nearest.
"""

# Shapes of the models that a few figures show, as solids; and of those of the table, all in the first mode.
SHOWN_SAMPLES = each_mode(
    "<results>/samples/{{category}}/{model}/{seed}/{mode}",
    FIGURE_MODELS,
    modes=SETTINGS.shown_mode,
    seeds=config["seeds"][:1],
)
TABLE_SAMPLES = expand(
    "<results>/samples/{{category}}/{model}/{seed}/{mode}",
    model=SETTINGS.table_models,
    seed=config["seeds"][:1],
    mode=config["modes"][0],
)
FIGURES = expand(
    "<results>/figures/{category}/{figure}.png",
    category=config["categories"],
    figure=[
        *("samples", "comparison", "interpolation", "arithmetic"),
        *("solids", "nearest", "training"),
    ],
)

PAPER_TARGETS += FIGURES


rule interpolate_shapes:
    input:
        unpack(model_fields),
        unpack(trained_model),
    output:
        meshes=directory("<results>/latent/{category}/{model}/{seed}/interpolation"),
    log:
        "<logs>/interpolate_shapes/{category}/{model}/{seed}.log",
    benchmark:
        "<benchmarks>/interpolate_shapes/{category}/{model}/{seed}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=3000,
    params:
        model=subpath(input.weights, parent=True),
        latent=section("latent"),
        meshing=meshing_options,
        code=model_code(
            "tetgan.studies.latent.interpolation", "meshing", "nn", "models", "studies"
        ),
    shell:
        "tetgan interpolate {params.model:q} {input.index:q} {output.meshes:q}"
        " --options {params.latent:q} --meshing {params.meshing:q} >{log:q} 2>&1"


rule add_parts:
    input:
        unpack(model_fields),
        unpack(trained_model),
    output:
        meshes=directory("<results>/latent/{category}/{model}/{seed}/arithmetic"),
    log:
        "<logs>/add_parts/{category}/{model}/{seed}.log",
    benchmark:
        "<benchmarks>/add_parts/{category}/{model}/{seed}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=3000,
    params:
        model=subpath(input.weights, parent=True),
        latent=section("latent"),
        meshing=meshing_options,
        code=model_code(
            "tetgan.studies.latent.arithmetic", "meshing", "nn", "models", "studies"
        ),
    shell:
        "tetgan arithmetic {params.model:q} {input.index:q} {output.meshes:q}"
        " --options {params.latent:q} --meshing {params.meshing:q} >{log:q} 2>&1"


rule find_nearest:
    input:
        samples="<results>/samples/{category}/{model}/{seed}/{mode}",
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
        catalogue="<results>/data/{category}/catalogue.csv",
    output:
        table="<results>/nearest/{category}/{model}/{seed}/{mode}.csv",
    log:
        "<logs>/find_nearest/{category}/{model}/{seed}/{mode}.log",
    benchmark:
        "<benchmarks>/find_nearest/{category}/{model}/{seed}/{mode}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=3000,
    params:
        options=section("nearest"),
        code=stage_digest("evaluation/novelty", "studies/nearest"),
    shell:
        "tetgan nearest {input.meshes:q} {output.table:q} --catalogue {input.catalogue:q}"
        " --samples {input.samples:q} --options {params.options:q} --threads {threads} >{log:q} 2>&1"


rule find_nearest_real:
    input:
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
        catalogue="<results>/data/{category}/catalogue.csv",
    output:
        table="<results>/nearest/{category}/real.csv",
    log:
        "<logs>/find_nearest_real/{category}.log",
    benchmark:
        "<benchmarks>/find_nearest_real/{category}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=3000,
    params:
        options=section("nearest"),
        code=stage_digest("evaluation/novelty", "studies/nearest"),
    shell:
        "tetgan nearest {input.meshes:q} {output.table:q} --catalogue {input.catalogue:q}"
        " --options {params.options:q} --threads {threads} >{log:q} 2>&1"


rule draw_samples:
    input:
        samples=SHOWN_SAMPLES,
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
    output:
        picture=report(
            "<results>/figures/{category}/samples.png",
            caption="../report/samples.rst",
            category="Figures",
            labels={"category": "{category}", "figure": "samples"},
        ),
        data="<results>/figures/{category}/samples.csv",
    log:
        "<logs>/draw_samples/{category}.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=1500,
    params:
        names=FIGURE_MODELS,
        columns=config["figures"]["columns"],
        code=stage_digest("rendering"),
    script:
        "../scripts/draw_samples.py"


rule draw_comparison:
    input:
        samples=TABLE_SAMPLES,
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
    output:
        picture=report(
            "<results>/figures/{category}/comparison.png",
            caption="../report/comparison.rst",
            category="Figures",
            labels={"category": "{category}", "figure": "comparison"},
        ),
        data="<results>/figures/{category}/comparison.csv",
    log:
        "<logs>/draw_comparison/{category}.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=1500,
    params:
        names=SETTINGS.table_models,
        columns=config["figures"]["columns"],
        code=stage_digest("rendering"),
    script:
        "../scripts/draw_comparison.py"


rule draw_solids:
    input:
        samples=SHOWN_SAMPLES,
    output:
        picture=report(
            "<results>/figures/{category}/solids.png",
            caption="../report/solids.rst",
            category="Figures",
            labels={"category": "{category}", "figure": "solids"},
        ),
        data="<results>/figures/{category}/solids.csv",
    log:
        "<logs>/draw_solids/{category}.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=1500,
    params:
        names=FIGURE_MODELS,
        code=stage_digest("rendering"),
    script:
        "../scripts/draw_solids.py"


rule draw_interpolation:
    input:
        folders=expand(
            "<results>/latent/{{category}}/{model}/{seed}/interpolation",
            model=FIGURE_MODELS,
            seed=config["seeds"][:1],
        ),
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
    output:
        picture=report(
            "<results>/figures/{category}/interpolation.png",
            caption="../report/interpolation.rst",
            category="Figures",
            labels={"category": "{category}", "figure": "interpolation"},
        ),
        data="<results>/figures/{category}/interpolation.csv",
    log:
        "<logs>/draw_interpolation/{category}.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=1500,
    params:
        names=FIGURE_MODELS,
        code=stage_digest("rendering"),
    script:
        "../scripts/draw_interpolation.py"


rule draw_arithmetic:
    input:
        folders=expand(
            "<results>/latent/{{category}}/{model}/{seed}/arithmetic",
            model=FIGURE_MODELS,
            seed=config["seeds"][:1],
        ),
    output:
        picture=report(
            "<results>/figures/{category}/arithmetic.png",
            caption="../report/arithmetic.rst",
            category="Figures",
            labels={"category": "{category}", "figure": "arithmetic"},
        ),
        data="<results>/figures/{category}/arithmetic.csv",
    log:
        "<logs>/draw_arithmetic/{category}.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=1500,
    params:
        names=FIGURE_MODELS,
        code=stage_digest("rendering"),
    script:
        "../scripts/draw_arithmetic.py"


rule draw_nearest:
    input:
        samples=SHOWN_SAMPLES,
        tables=each_mode(
            "<results>/nearest/{{category}}/{model}/{seed}/{mode}.csv",
            FIGURE_MODELS,
            modes=SETTINGS.shown_mode,
            seeds=config["seeds"][:1],
        ),
        real="<results>/nearest/{category}/real.csv",
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
    output:
        picture=report(
            "<results>/figures/{category}/nearest.png",
            caption="../report/nearest.rst",
            category="Figures",
            labels={"category": "{category}", "figure": "nearest training shape"},
        ),
        data="<results>/figures/{category}/nearest.csv",
    log:
        "<logs>/draw_nearest/{category}.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=1500,
    params:
        names=FIGURE_MODELS,
        columns=config["figures"]["columns"],
        code=stage_digest("rendering"),
    script:
        "../scripts/draw_nearest.py"


rule draw_training:
    input:
        weights=expand(
            "<results>/models/{{category}}/{model}/{seed}/weights.safetensors",
            model=LOGGED_MODELS,
            seed=config["seeds"],
        ),
    output:
        picture=report(
            "<results>/figures/{category}/training.png",
            caption="../report/training.rst",
            category="Figures",
            labels={"category": "{category}", "figure": "training"},
        ),
        data="<results>/figures/{category}/training.csv",
    log:
        "<logs>/draw_training/{category}.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=500,
    params:
        names=[name for name in LOGGED_MODELS for _ in config["seeds"]],
        seeds=[seed for _ in LOGGED_MODELS for seed in config["seeds"]],
        code=stage_digest("rendering"),
    script:
        "../scripts/draw_training.py"


if config["ablation"]:
    PAPER_TARGETS += expand(
        "<results>/figures/{category}/ablation-training.png",
        category=config["categories"][:1],
    )

    use rule draw_training as draw_ablation_training with:
        input:
            weights=expand(
                "<results>/models/{{category}}/{model}/{seed}/weights.safetensors",
                model=ABLATED_MODELS,
                seed=config["seeds"],
            ),
        output:
            picture=report(
                "<results>/figures/{category}/ablation-training.png",
                caption="../report/ablation-training.rst",
                category="Figures",
                labels={
                    "category": "{category}",
                    "figure": "training of the ablation",
                },
            ),
            data="<results>/figures/{category}/ablation-training.csv",
        log:
            "<logs>/draw_ablation_training/{category}.log",
        params:
            names=[name for name in ABLATED_MODELS for _ in config["seeds"]],
            seeds=[seed for _ in ABLATED_MODELS for seed in config["seeds"]],
            code=stage_digest("rendering"),


rule figures:
    input:
        FIGURES,
